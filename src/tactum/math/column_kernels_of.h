#pragma once
/// The loops of column_kernels.h for a number of lanes. Included by the files that compile them for a
/// processor, and includes nothing that could be compiled for another one as well.

#include <cstring>

#include "tactum/math/column_kernels.h"

namespace tactum::inline v0_1::columns {

/// Vectors of so many numbers, as g++ and clang++ share them.
template <std::size_t Width>
struct LanesOf;
template <>
struct LanesOf<2> {
  using Type = double __attribute__((vector_size(16)));
};
template <>
struct LanesOf<4> {
  using Type = double __attribute__((vector_size(32)));
};

template <std::size_t Width>
struct KernelsOf {
  using Lanes = typename LanesOf<Width>::Type;

  static void load(const double* x, Lanes& lanes) { std::memcpy(&lanes, x, sizeof lanes); }
  static void store(const Lanes& lanes, double* x) { std::memcpy(x, &lanes, sizeof lanes); }
  static void add(double times, const double* x, Lanes& sum) {
    Lanes lanes;
    load(x, lanes);
    sum += times * lanes;
  }

  static void combine(const double* columns, std::size_t count, const double* shares, double sign,
                      std::size_t n, double* to) {
    constexpr std::size_t kSums = 8 / Width;
    for (std::size_t i = 0; i < n; i += 8) {
      Lanes sum[kSums];
      for (std::size_t s = 0; s < kSums; ++s) load(to + i + s * Width, sum[s]);
      for (std::size_t k = 0; k < count; ++k)
        for (std::size_t s = 0; s < kSums; ++s)
          add(sign * shares[k], columns + k * kColumn + i + s * Width, sum[s]);
      for (std::size_t s = 0; s < kSums; ++s) store(sum[s], to + i + s * Width);
    }
  }

  static double dot(const double* x, const double* y, std::size_t n) {
    constexpr std::size_t kSums = 4 / Width;
    Lanes sum[kSums]{};
    for (std::size_t i = 0; i < n; i += 4)
      for (std::size_t s = 0; s < kSums; ++s) {
        Lanes a;
        Lanes b;
        load(x + i + s * Width, a);
        load(y + i + s * Width, b);
        sum[s] += a * b;
      }
    double four[4];
    std::memcpy(four, sum, sizeof four);
    return (four[0] + four[2]) + (four[1] + four[3]);
  }

  static void dots(const double* columns, std::size_t count, const double* x, std::size_t n, double* shares) {
    for (std::size_t k = 0; k < count; ++k) shares[k] = dot(columns + k * kColumn, x, n);
  }

  static void solve_upper(const double* columns, const double* reciprocal, std::size_t count, double* rest,
                          double* x) {
    for (std::size_t j = count; j-- > 0;) {
      x[j] = rest[j] * reciprocal[j];
      for (std::size_t i = 0; i < j; i += Width) {
        Lanes left;
        load(rest + i, left);
        add(-x[j], columns + j * kColumn + i, left);
        store(left, rest + i);
      }
    }
  }

  static void turn(double cosine, double sine, std::size_t n, double* one, double* other) {
    for (std::size_t i = 0; i < n; i += Width) {
      Lanes a;
      Lanes b;
      load(one + i, a);
      load(other + i, b);
      store(cosine * a + sine * b, one + i);
      store(cosine * b - sine * a, other + i);
    }
  }

  static constexpr Kernels table() { return {combine, dots, dot, solve_upper, turn}; }
};

}  // namespace tactum::inline v0_1::columns
