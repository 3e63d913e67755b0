#include "formats/writer.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "formats/aligned_bytes.hpp"
#include "formats/describe.hpp"
#include "formats/model_file.hpp"
#include "formats/testing/synthetic_model.hpp"
#include "formats/verify.hpp"

namespace greenloop {
namespace {

TEST_CASE("writer: smoke") {
  for (std::uint32_t levels : {1u, 2u, 3u, 4u}) {
    SyntheticOptions o;
    o.levels = levels;
    auto bytes = encode(synthetic_model(o));
    ModelView view;
    AlignedBytes a(bytes);
    auto r = verify(a.span(), view);
    CAPTURE(describe(r));
    REQUIRE(r.ok());
    const auto& f = *view.level[levels - 1].counts;
    MESSAGE(bytes.size(), " ", view.node_count, " ", f.column_count, " ", f.kept_blocks, " ", f.dense_blocks, " ",
            f.rms_error, " ", f.worst_column_error);
    for (std::uint32_t q = 0; q < levels; ++q) truncate_to_level(bytes, q);
  }
}

}  // namespace
}  // namespace greenloop
