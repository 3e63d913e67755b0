#include "offline/compress/compressed_compliance.hpp"

#include <algorithm>
#include <utility>

#include "offline/compress/scale.hpp"

namespace greenloop::offline {
namespace {

// y += M f for every column; M: 9 numbers 3 c + r
void multiply(const float* m, bool transposed, std::size_t columns, const double* f, double* y) {
  for (std::size_t k = 0; k < columns; ++k, f += 3, y += 3) {
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) y[r] += static_cast<double>(transposed ? m[3 * r + c] : m[3 * c + r]) * f[c];
    }
  }
}

bool any(const double* f, std::size_t count) {
  return std::any_of(f, f + count, [](double x) { return x != 0; });
}

std::int16_t value_at(const CouplingsView& couplings, std::size_t block, std::size_t k) {
  if (couplings.value_bits == 16) return reinterpret_cast<const std::int16_t*>(couplings.value)[9 * block + k];
  if (couplings.value_bits == 8) return reinterpret_cast<const std::int8_t*>(couplings.value)[9 * block + k];
  const auto byte = static_cast<unsigned>(couplings.value[5 * block + k / 2]);
  const unsigned nibble = (k % 2 == 0 ? byte : byte >> 4) & 15;
  return static_cast<std::int16_t>(nibble < 8 ? static_cast<int>(nibble) : static_cast<int>(nibble) - 16);
}

std::uint32_t row_at(const CouplingsView& couplings, std::size_t column, std::size_t block) {
  if (couplings.index_bytes == 2) return static_cast<const std::uint16_t*>(couplings.index)[block];
  if (couplings.index_bytes == 4) return static_cast<const std::uint32_t*>(couplings.index)[block];
  return static_cast<std::uint32_t>(block - couplings.begin[column]);
}

void append(const float (&six)[6], std::vector<float>& matrices) {
  const Eigen::Matrix3f matrix = symmetric_matrix(six).cast<float>();
  matrices.insert(matrices.end(), matrix.data(), matrix.data() + 9);
}

}  // namespace

CompressedCompliance::CompressedCompliance(const ModelView& view, std::uint32_t layers) : wavelet_(view) {
  number_coefficients(view);
  load_couplings(view, layers);
}

void CompressedCompliance::number_coefficients(const ModelView& view) {
  const auto add = [this](const layout::Scale& scale, std::uint32_t needs) {
    append(scale.root, root_);
    append(scale.diagonal, diagonal_);
    needs_level_.push_back(needs);
  };
  for (std::uint32_t level = 0; level < view.levels; ++level) {
    const LevelView& at = view.level[level];
    for (std::uint32_t i = 0; i < at.counts->domain_count; ++i) {
      add(level == 0 ? at.averages[i] : at.details[i], level);
    }
  }
  averages_.resize(view.levels);
  for (std::uint32_t level = 1; level + 2 < view.levels; ++level) {
    averages_[level] = {.begin = needs_level_.size(), .count = rows(level)};
    for (std::size_t i = 0; i < rows(level); ++i) add(view.level[level].averages[i], level + 2);
  }
}

void CompressedCompliance::load_couplings(const ModelView& view, std::uint32_t layers) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends;  // row, column
  for (std::uint32_t level = 0; level < view.levels; ++level) {
    const std::size_t own = level > 0 ? rows(level - 1) : 0;
    const std::size_t parents = level > 1 ? rows(level - 2) : 0;
    const std::size_t averages = level > 2 ? averages_[level - 2].begin : 0;
    const std::size_t first_row[3] = {averages, parents, own};
    for (std::size_t partner = 0; partner < 3; ++partner) {
      for (std::uint32_t layer = 0; layer < layers; ++layer) {
        const CouplingsView& couplings = view.level[level].couplings[partner][layer];
        for (std::size_t j = 0; j < couplings.columns; ++j) {
          for (std::size_t b = couplings.begin[j]; b < couplings.begin[j + 1]; ++b) {
            ends.emplace_back(first_row[partner] + row_at(couplings, j, b), own + j);
            for (std::size_t k = 0; k < 9; ++k) {
              block_.push_back(couplings.quantum * static_cast<float>(value_at(couplings, b, k)));
            }
          }
        }
      }
    }
  }
  link(ends);
}

void CompressedCompliance::link(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& ends) {
  link_begin_.assign(needs_level_.size() + 1, 0);
  for (const auto& [row, column] : ends) {
    ++link_begin_[row + 1];
    ++link_begin_[column + 1];
  }
  for (std::size_t i = 1; i < link_begin_.size(); ++i) link_begin_[i] += link_begin_[i - 1];
  links_.resize(2 * ends.size());
  auto next = link_begin_;
  for (std::uint32_t b = 0; b < ends.size(); ++b) {
    const auto& [row, column] = ends[b];
    links_[next[column]++] = {.other = row, .block = b, .transposed = false};
    links_[next[row]++] = {.other = column, .block = b, .transposed = true};
  }
}

void CompressedCompliance::apply(std::size_t level, std::size_t columns, const double* f, double* x) const {
  const std::size_t width = 3 * columns;
  std::vector<double> force(needs_level_.size() * width, 0.0);
  std::copy_n(f, rows(level) * width, force.begin());
  for (std::size_t l = level; l > 0; --l) {
    wavelet_.split_forces(l, width, force.data());
    if (averages_[l - 1].count > 0 && l < level) {
      std::copy_n(force.begin(), rows(l - 1) * width,
                  force.begin() + static_cast<std::ptrdiff_t>(averages_[l - 1].begin * width));
    }
  }

  std::vector<double> sum(force.size(), 0.0);
  std::vector<double> scaled(width);
  for (std::size_t i = 0; i < needs_level_.size(); ++i) {
    const double* own = force.data() + i * width;
    if (needs_level_[i] > level || !any(own, width)) continue;
    std::fill(scaled.begin(), scaled.end(), 0.0);
    multiply(root_.data() + 9 * i, false, columns, own, scaled.data());
    if (i < wavelet_.rows()) {
      multiply(diagonal_.data() + 9 * i, false, columns, scaled.data(), sum.data() + i * width);
    }
    for (std::size_t at = link_begin_[i]; at < link_begin_[i + 1]; ++at) {
      const Link& link = links_[at];
      if (needs_level_[link.other] > level) continue;
      multiply(block_.data() + std::size_t{9} * link.block, link.transposed, columns, scaled.data(),
               sum.data() + std::size_t{link.other} * width);
    }
  }

  std::vector<double> value(force.size(), 0.0);
  for (std::size_t i = 0; i < needs_level_.size(); ++i) {
    multiply(root_.data() + 9 * i, false, columns, sum.data() + i * width, value.data() + i * width);
  }
  for (std::size_t l = 1; l <= level; ++l) {
    const Role& partners = averages_[l - 1];
    for (std::size_t k = 0; k < partners.count * width; ++k) value[k] += value[partners.begin * width + k];
    wavelet_.merge(l, width, value.data());
  }
  std::copy_n(value.begin(), rows(level) * width, x);
}

std::vector<double> CompressedCompliance::column(std::size_t level, std::size_t j) const {
  std::vector<double> f(9 * rows(level), 0.0), x(9 * rows(level));
  for (std::size_t c = 0; c < 3; ++c) f[9 * j + 4 * c] = 1;
  apply(level, 3, f.data(), x.data());
  return x;
}

}  // namespace greenloop::offline
