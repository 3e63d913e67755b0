#include <algorithm>

#include "formats/testing/reseal_stream.hpp"
#include "formats/testing/smallest_model.hpp"
#include "formats/testing/synthetic_model.hpp"
#include "formats/transport/stream.hpp"
#include "formats/verify.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "rt_tests/fuzz/doors.hpp"

namespace greenloop {
namespace {

constexpr std::size_t first_packet = sizeof(transport::StreamHeader) + sizeof(transport::PacketHeader);

class TransportDoor final : public Door {
 public:
  TransportDoor() {
    for (const ModelData& model :
         {smallest_model(), smallest_scalar_model(), synthetic_model({.levels = 1}), synthetic_model({.levels = 2}),
          synthetic_model({.components = 1, .levels = 2, .vertices = 4}),
          synthetic_model({.levels = 2, .gravity = true, .pressures = 1}),
          synthetic_model({.levels = 2, .wavelet = layout::Wavelet::equilibrated}), crowded_model(8, 3)}) {
      seeds_.push_back(transport::pack(encode(model)));
    }
  }

  bool try_one(Random& random) override {
    Bytes stream = one_of(random, seeds_);
    if (below(random, 4) == 0) {  // what the coder reads is arbitrary
      const std::size_t at = first_packet + below(random, std::max<std::size_t>(stream.size() - first_packet, 1));
      for (std::size_t i = at; i < std::min(stream.size(), at + 64); ++i) stream[i] = static_cast<std::byte>(random());
    }
    mutate_bytes(random, first_packet + 32, stream);
    transport::reseal_stream(stream);
    transport::UnpackedModel unpacked;
    const transport::StreamResult result = transport::unpack(stream, unpacked);
    require_right(!describe(result).empty(), "no word on a stream");
    if (unpacked.model.empty()) return false;
    ModelView view;
    require_right(verify(AlignedBytes(unpacked.model).span(), view).ok(), "a stream gave a model that is not valid");
    return true;
  }

 private:
  std::vector<Bytes> seeds_;
};

}  // namespace

std::unique_ptr<Door> transport_door() { return std::make_unique<TransportDoor>(); }

}  // namespace greenloop
