#include "formats/write/multigrid.hpp"

#include <fmt/format.h>

#include <span>
#include <stdexcept>
#include <utility>

#include "formats/layout/multigrid_order.hpp"
#include "formats/verify.hpp"
#include "formats/write/describe.hpp"
#include "formats/write/section_file.hpp"

namespace greenloop {
namespace {

using layout::SectionKind;
using Bytes = std::vector<std::byte>;

template <class Record>
Bytes bytes_of(const std::vector<Record>& records) {
  const auto bytes = std::as_bytes(std::span(records));
  return {bytes.begin(), bytes.end()};
}

std::uint32_t count(std::size_t size) { return static_cast<std::uint32_t>(size); }

layout::MultigridInfo completed_info(const MultigridData& model) {
  layout::MultigridInfo info = model.info;
  info.problem = static_cast<std::uint32_t>(layout::Problem::multigrid);
  info.components = 3;
  info.levels = 1;
  info.vertices = count(model.points.size() / 3);
  info.tetrahedra = count(model.tetrahedra.size());
  info.matters = count(model.matters.size());
  info.shown = count(model.shown_points.size() / 3);
  info.triangles = count(model.shown_triangles.size() / 3);
  info.grids = count(model.grids.size()) + 1;
  info.coarsest_vertices = model.coarsest_vertices;
  return info;
}

layout::GridRecord grid_record(const MultigridData& model, std::size_t g) {
  const GridData& grid = model.grids[g];
  const std::uint32_t coarser =
      g + 1 < model.grids.size() ? count(model.grids[g + 1].row_uppers.size()) : model.coarsest_vertices;
  return {count(grid.row_uppers.size()), count(grid.columns.size()), count(grid.parents.size()), coarser};
}

Bytes section_bytes(const MultigridData& model, SectionKind kind, std::uint32_t g) {
  switch (kind) {
    case SectionKind::level:
      return bytes_of(std::vector{layout::MultigridLevelRecord{}});
    case SectionKind::points:
      return bytes_of(model.points);
    case SectionKind::tetrahedra:
      return bytes_of(model.tetrahedra);
    case SectionKind::matters:
      return bytes_of(model.matters);
    case SectionKind::shown_points:
      return bytes_of(model.shown_points);
    case SectionKind::shown_triangles:
      return bytes_of(model.shown_triangles);
    case SectionKind::bindings:
      return bytes_of(model.bindings);
    case SectionKind::grid:
      return bytes_of(std::vector{grid_record(model, g)});
    case SectionKind::row_starts:
      return bytes_of(model.grids[g].row_starts);
    case SectionKind::row_uppers:
      return bytes_of(model.grids[g].row_uppers);
    case SectionKind::columns:
      return bytes_of(model.grids[g].columns);
    case SectionKind::blocks:
      return bytes_of(model.grids[g].blocks);
    case SectionKind::inverses:
      return bytes_of(model.grids[g].inverses);
    case SectionKind::parent_starts:
      return bytes_of(model.grids[g].parent_starts);
    case SectionKind::parents:
      return bytes_of(model.grids[g].parents);
    case SectionKind::weights:
      return bytes_of(model.grids[g].weights);
    case SectionKind::coarsest_factor:
      return bytes_of(model.coarsest_factor);
    default:
      return {};  // no other kind is in the order
  }
}

}  // namespace

ModelFile encoded_file(const MultigridData& model) {
  const layout::MultigridInfo info = completed_info(model);
  std::vector<SectionBytes> sections;
  const auto add = [&](SectionKind kind, std::uint32_t a, Bytes bytes) {
    layout::SectionEntry entry{};
    entry.kind = static_cast<std::uint32_t>(kind);
    entry.a = static_cast<std::uint16_t>(a);
    sections.push_back({entry, std::move(bytes)});
  };
  add(SectionKind::info, 0, bytes_of(std::vector{info}));
  add(SectionKind::provenance, 0, bytes_of(std::vector<char>(model.provenance.begin(), model.provenance.end())));
  layout::visit_multigrid(info, [&](SectionKind kind, std::uint32_t a, std::uint32_t) {
    add(kind, a, section_bytes(model, kind, a));
    return true;
  });
  ModelFile file{AlignedBytes(file_of(std::move(sections), 1, layout::first_minor(layout::Problem::multigrid))), {}};
  const VerifyResult result = verify(file.bytes.span(), file.view);
  if (!result.ok()) throw std::invalid_argument("multigrid model to be written: " + describe(result));
  return file;
}

std::vector<std::byte> encode(const MultigridData& model) {
  const ModelFile file = encoded_file(model);
  const auto bytes = file.bytes.span();
  return {bytes.begin(), bytes.end()};
}

}  // namespace greenloop
