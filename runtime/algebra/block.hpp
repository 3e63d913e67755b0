#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "runtime/algebra/float4.hpp"

namespace greenloop {

// Vectors and blocks of N components a node, 3 or 1, with the same functions for both: what is done with them is
// written once.

namespace detail {
template <unsigned N>
struct VectorOf;
template <>
struct VectorOf<3> {
  using type = Float4;
};
template <>
struct VectorOf<1> {
  using type = float;
};
}  // namespace detail

/// What stands at a node: x y z 0, or one number.
template <unsigned N>
using Vector = typename detail::VectorOf<N>::type;

/// An N x N block by columns; fourth lanes undefined.
template <unsigned N>
struct Block {
  Vector<N> column[N];
};

/// Each component of a vector in all lanes.
template <unsigned N>
struct Splats {
  Vector<N> of[N];
};

/// Each element of a block in all lanes.
template <unsigned N>
struct BlockSplats {
  Splats<N> column[N];
};

/// From N floats, with a fourth lane of 0.
template <unsigned N>
Vector<N> load_vector(const float* at);
template <>
inline Float4 load_vector<3>(const float* at) {
  return Float4{at[0], at[1], at[2], 0.0F};
}
template <>
inline float load_vector<1>(const float* at) {
  return *at;
}

/// Component k < N.
inline float component(Float4 x, std::size_t k) { return x[k]; }
inline float component(float x, std::size_t) { return x; }

/// A vector with a fourth lane of 0.
inline Float4 components(Float4 x) { return xyz(x); }
inline float components(float x) { return x; }

/// a + b, whose fourth lanes are 0.
inline Float4 added(Float4 a, Float4 b) {
#if defined(__SSE2__) || defined(__ARM_NEON)
  return a + b;
#else
  return Float4{a[0] + b[0], a[1] + b[1], a[2] + b[2], 0.0F};
#endif
}
inline float added(float a, float b) { return a + b; }

/// Half of their sum; fourth lanes are 0.
inline Float4 mean(Float4 a, Float4 b) { return Float4{0.5F, 0.5F, 0.5F, 0.0F} * added(a, b); }
inline float mean(float a, float b) { return 0.5F * (a + b); }

inline Float4 scaled(float factor, Float4 x) { return splat(factor) * x; }
inline float scaled(float factor, float x) { return factor * x; }

inline Splats<3> splats(Float4 x) { return {{splat(x[0]), splat(x[1]), splat(x[2])}}; }
inline Splats<1> splats(float x) { return {{x}}; }

/// The same with fourth lanes of 0.
inline Splats<3> component_splats(Float4 x) {
  return {{Float4{x[0], x[0], x[0], 0.0F}, Float4{x[1], x[1], x[1], 0.0F}, Float4{x[2], x[2], x[2], 0.0F}}};
}
inline Splats<1> component_splats(float x) { return {{x}}; }

inline BlockSplats<3> splats(const Block<3>& m) {
  BlockSplats<3> result;
  for (std::size_t k = 0; k < 9; ++k) {
    result.column[k / 3].of[k % 3] = splat(m.column[k / 3][k % 3]);
  }
  return result;
}
inline BlockSplats<1> splats(const Block<1>& m) { return {{splats(m.column[0])}}; }

inline Block<3> transposed(const Block<3>& m) {
  const Float4 low = __builtin_shufflevector(m.column[0], m.column[1], 0, 4, 1, 5);
  const Float4 high = __builtin_shufflevector(m.column[0], m.column[1], 2, 6, 3, 7);
  return {{__builtin_shufflevector(low, m.column[2], 0, 1, 4, 7), __builtin_shufflevector(low, m.column[2], 2, 3, 5, 7),
           __builtin_shufflevector(high, m.column[2], 0, 1, 6, 7)}};
}
inline Block<1> transposed(const Block<1>& m) { return m; }

inline Block<3> scaled(float factor, const Block<3>& m) {
  const Float4 of_all = splat(factor);
  return {{of_all * m.column[0], of_all * m.column[1], of_all * m.column[2]}};
}
inline Block<1> scaled(float factor, const Block<1>& m) { return {{factor * m.column[0]}}; }

/// sum += m
inline void add(const Block<3>& m, Block<3>& sum) {
  for (std::size_t c = 0; c < 3; ++c) {
    if constexpr (has_vectors) {
      sum.column[c] += m.column[c];
    } else {
      for (std::size_t r = 0; r < 3; ++r) {
        sum.column[c][r] += m.column[c][r];
      }
    }
  }
}
inline void add(const Block<1>& m, Block<1>& sum) { sum.column[0] += m.column[0]; }

/// sum += weight m
inline void add(float weight, const Block<3>& m, Block<3>& sum) {
  for (std::size_t c = 0; c < 3; ++c) {
    if constexpr (has_vectors) {
      sum.column[c] += splat(weight) * m.column[c];
    } else {
      for (std::size_t r = 0; r < 3; ++r) {
        sum.column[c][r] += weight * m.column[c][r];
      }
    }
  }
}
inline void add(float weight, const Block<1>& m, Block<1>& sum) { sum.column[0] += weight * m.column[0]; }

/// Block times vector: the fourth lane is 0 if that of `x` is.
inline Float4 product(const Block<3>& m, const Splats<3>& x) {
  if constexpr (has_vectors) {
    return (m.column[0] * x.of[0] + m.column[1] * x.of[1]) + m.column[2] * x.of[2];
  } else {
    const auto row = [&](std::size_t r) {
      return (m.column[0][r] * x.of[0][r] + m.column[1][r] * x.of[1][r]) + m.column[2][r] * x.of[2][r];
    };
    return Float4{row(0), row(1), row(2), 0.0F};
  }
}
inline float product(const Block<1>& m, const Splats<1>& x) { return m.column[0] * x.of[0]; }

/// Block times vector: the fourth lane is 0 if those of the block are.
inline Float4 product(const Block<3>& m, Float4 x) { return product(m, splats(x)); }
inline float product(const Block<1>& m, float x) { return m.column[0] * x; }

/// Product of two blocks: fourth lanes are 0 if those of `a` are.
inline Block<3> product(const Block<3>& a, const BlockSplats<3>& b) {
  return {{product(a, b.column[0]), product(a, b.column[1]), product(a, b.column[2])}};
}
inline Block<1> product(const Block<1>& a, const BlockSplats<1>& b) { return {{product(a, b.column[0])}}; }

/// Product of two blocks: fourth lanes are 0 if those of `a` are.
inline Block<3> product(const Block<3>& a, const Block<3>& b) {
  return {{product(a, b.column[0]), product(a, b.column[1]), product(a, b.column[2])}};
}
inline Block<1> product(const Block<1>& a, const Block<1>& b) { return {{a.column[0] * b.column[0]}}; }

/// Transposed block times vector: the fourth lane is 0 if that of `x` is.
inline Float4 transposed_product(const Block<3>& m, Float4 x) {
  const Block<3> rows = transposed(Block<3>{{m.column[0] * x, m.column[1] * x, m.column[2] * x}});
  return (rows.column[0] + rows.column[1]) + rows.column[2];
}
inline float transposed_product(const Block<1>& m, float x) { return m.column[0] * x; }

/// A symmetric matrix, as layout::Scale has it, as a block with fourth lanes of 0.
inline Block<3> symmetric_block(const float (&matrix)[6]) {
  Float4 low;
  Float4 high;
  std::memcpy(&low, matrix, sizeof low);
  std::memcpy(&high, matrix + 2, sizeof high);
  return {{xyz(low), xyz(__builtin_shufflevector(low, high, 1, 3, 6, 6)),
           xyz(__builtin_shufflevector(high, high, 0, 2, 3, 3))}};
}
inline Block<1> symmetric_block(const float (&matrix)[1]) { return {{matrix[0]}}; }

/// A symmetric matrix, as layout::Scale has it, times a vector; the fourth lane is 0.
inline Float4 symmetric_product(const float (&matrix)[6], Float4 x) {
#if defined(__SSE2__) || defined(__ARM_NEON)
  Float4 low;
  Float4 high;
  std::memcpy(&low, matrix, sizeof low);
  std::memcpy(&high, matrix + 2, sizeof high);
  const Float4 second = __builtin_shufflevector(low, high, 1, 3, 6, 6);
  const Float4 third = __builtin_shufflevector(high, high, 0, 2, 3, 3);
  return xyz((low * splat(x[0]) + second * splat(x[1])) + third * splat(x[2]));
#else
  const auto row = [&](std::size_t a, std::size_t b, std::size_t c) {
    return (matrix[a] * x[0] + matrix[b] * x[1]) + matrix[c] * x[2];
  };
  return Float4{row(0, 1, 2), row(1, 3, 4), row(2, 4, 5), 0.0F};
#endif
}
inline float symmetric_product(const float (&matrix)[1], float x) { return matrix[0] * x; }

}  // namespace greenloop
