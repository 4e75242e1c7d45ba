// SPDX-License-Identifier: BSD-3-Clause
/// @file Sparse Cholesky factorisation of matrices made of small dense blocks.
///
/// A pose graph's matrices consist of 3x3 (poses), 2x2 (positions) or complex (headings) blocks. Working on whole blocks asks for each
/// index once where a factorisation of single numbers asks nine times.
#pragma once
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/StdVector>
#include <cmath>
#include <vector>

#include "common/graph/block_pattern.hpp"

namespace modslam {

/// L L* = A for a Hermitian A over a BlockPattern, N x N blocks. Fill with clear() and add(), then factorize(), then solve().
/// Left-looking: each column takes what the columns before it leave (Davis 2006, section 4.10, with blocks for numbers).
template <class Scalar, int N>
class BlockCholesky {
 public:
  using Block = Eigen::Matrix<Scalar, N, N>;
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;  ///< N numbers a variable, in the order of variables

  /// @param pattern  must outlive this.
  explicit BlockCholesky(const BlockPattern& pattern)
      : pattern_(&pattern),
        diagonal_(static_cast<std::size_t>(pattern.variables())),
        below_(static_cast<std::size_t>(pattern.blocks())),
        slot_(diagonal_.size()) {
    clear();
  }

  void clear() {
    for (Block& block : diagonal_) block.setZero();
    for (Padded& block : below_) block.setZero();
  }
  /// The diagonal block of a variable; only its lower triangle is read.
  Block& diagonal(int variable) { return diagonal_[static_cast<std::size_t>(pattern_->place(variable))]; }
  /// Adds to A's block at (row of the variable with the later place, column of the other), see BlockPattern::entry.
  template <class Derived>
  void add_below(int entry, const Eigen::MatrixBase<Derived>& block) {
    below_[static_cast<std::size_t>(entry)].template topRows<N>() += block;
  }

  /// Replaces A by L.
  /// @param hold  what to do where a pivot is not positive (A does not say anything there, or A is no sum of squares): true holds that
  ///              unknown, so that solve() gives it 0; false gives up.
  /// @return false when it gave up; the numbers are useless then.
  bool factorize(bool hold);
  /// @return x with A x = b.
  Vector solve(const Vector& b) const;
  /// Diagonal blocks of A's inverse, in the order of variables. Only what the pattern holds of the inverse is computed (Takahashi, Fagan,
  /// Chen 1973): a small multiple of factorize().
  std::vector<Block> inverse_diagonal() const;

 private:
  // An even count of rows lets two rows be worked on at once.
  static constexpr int kRows = N == 3 && Eigen::NumTraits<Scalar>::IsComplex == 0 ? 4 : N;
  using Padded = Eigen::Matrix<Scalar, kRows, N>;

  using Reals = Eigen::Matrix<double, N, 1>;
  static bool factorize_diagonal(Block& A, const Reals& scale, bool hold);

  const BlockPattern* pattern_;
  std::vector<Block, Eigen::aligned_allocator<Block>> diagonal_, inverse_;  // inverse_: of the lower triangles on L's diagonal
  std::vector<Padded, Eigen::aligned_allocator<Padded>> below_;
  std::vector<int> slot_;  // of a row in the column that is worked on
};

template <class Scalar, int N>
bool BlockCholesky<Scalar, N>::factorize_diagonal(Block& A, const Reals& scale, bool hold) {
  constexpr double kRounding = 1e-14, kHeld = 1e150;
  for (int c = 0; c < N; ++c) {
    double pivot = Eigen::numext::real(A(c, c));
    for (int k = 0; k < c; ++k) pivot -= Eigen::numext::abs2(A(c, k));
    if (!(pivot > kRounding * scale[c])) {
      if (!hold) return false;
      pivot = kHeld;
    }
    const double root = std::sqrt(pivot);
    A(c, c) = Scalar(root);
    for (int r = c + 1; r < N; ++r) {
      Scalar sum = A(r, c);
      for (int k = 0; k < c; ++k) sum -= A(r, k) * Eigen::numext::conj(A(c, k));
      A(r, c) = sum / root;
    }
    for (int r = 0; r < c; ++r) A(r, c) = Scalar(0);
  }
  return true;
}

template <class Scalar, int N>
bool BlockCholesky<Scalar, N>::factorize(bool hold) {
  const BlockPattern& pattern = *pattern_;
  const int n = pattern.variables();
  inverse_.resize(diagonal_.size());
  // Columns k whose next row to be used is j hang in a list at head[j].
  std::vector<int> head(diagonal_.size(), -1), next(diagonal_.size(), -1), used(diagonal_.size());
  const auto hang = [&](int k) {
    if (used[static_cast<std::size_t>(k)] >= pattern.begin(k + 1)) return;
    const auto j = static_cast<std::size_t>(pattern.row(used[static_cast<std::size_t>(k)]));
    next[static_cast<std::size_t>(k)] = head[j];
    head[j] = k;
  };
  for (int j = 0; j < n; ++j) {
    Block& D = diagonal_[static_cast<std::size_t>(j)];
    const Reals scale = D.diagonal().real();
    const int first = pattern.begin(j), last = pattern.begin(j + 1);
    for (int e = first; e < last; ++e) slot_[static_cast<std::size_t>(pattern.row(e))] = e;
    for (int k = head[static_cast<std::size_t>(j)]; k >= 0;) {
      const int following = next[static_cast<std::size_t>(k)], at = used[static_cast<std::size_t>(k)]++;
      const Block Ljk = below_[static_cast<std::size_t>(at)].template topRows<N>(), Ljk_adjoint = Ljk.adjoint();
      D.noalias() -= Ljk.lazyProduct(Ljk_adjoint);
      for (int e = at + 1, end = pattern.begin(k + 1); e < end; ++e) {
        Padded& into = below_[static_cast<std::size_t>(slot_[static_cast<std::size_t>(pattern.row(e))])];
        into.noalias() -= below_[static_cast<std::size_t>(e)].lazyProduct(Ljk_adjoint);
      }
      hang(k);
      k = following;
    }
    if (!factorize_diagonal(D, scale, hold)) return false;
    Block& D_inverse = inverse_[static_cast<std::size_t>(j)];
    D_inverse = D.template triangularView<Eigen::Lower>().solve(Block::Identity());
    const Block D_inverse_adjoint = D_inverse.adjoint();
    for (int e = first; e < last; ++e) {
      Padded& L = below_[static_cast<std::size_t>(e)];
      L = L.lazyProduct(D_inverse_adjoint).eval();
    }
    used[static_cast<std::size_t>(j)] = first;
    hang(j);
  }
  return true;
}

template <class Scalar, int N>
typename BlockCholesky<Scalar, N>::Vector BlockCholesky<Scalar, N>::solve(const Vector& b) const {
  const BlockPattern& pattern = *pattern_;
  const int n = pattern.variables();
  const auto at = [](int k) { return static_cast<Eigen::Index>(k) * N; };
  Vector x(b.size()), out(b.size());
  for (int v = 0; v < n; ++v) x.template segment<N>(at(pattern.place(v))) = b.template segment<N>(at(v));
  for (int c = 0; c < n; ++c) {
    const Eigen::Matrix<Scalar, N, 1> y = inverse_[static_cast<std::size_t>(c)] * x.template segment<N>(at(c));
    x.template segment<N>(at(c)) = y;
    for (int e = pattern.begin(c); e < pattern.begin(c + 1); ++e)
      x.template segment<N>(at(pattern.row(e))) -= below_[static_cast<std::size_t>(e)].template topRows<N>() * y;
  }
  for (int c = n - 1; c >= 0; --c) {
    Eigen::Matrix<Scalar, N, 1> y = x.template segment<N>(at(c));
    for (int e = pattern.begin(c); e < pattern.begin(c + 1); ++e)
      y -= below_[static_cast<std::size_t>(e)].template topRows<N>().adjoint() * x.template segment<N>(at(pattern.row(e)));
    x.template segment<N>(at(c)) = inverse_[static_cast<std::size_t>(c)].adjoint() * y;
  }
  for (int v = 0; v < n; ++v) out.template segment<N>(at(v)) = x.template segment<N>(at(pattern.place(v)));
  return out;
}

template <class Scalar, int N>
std::vector<typename BlockCholesky<Scalar, N>::Block> BlockCholesky<Scalar, N>::inverse_diagonal() const {
  const BlockPattern& pattern = *pattern_;
  const int n = pattern.variables();
  std::vector<Block> Z_diagonal(diagonal_.size()), Z_below(below_.size(), Block::Zero()), W(below_.size());
  std::vector<int> slot(diagonal_.size(), -1);  // of a row in column j
  for (int j = n - 1; j >= 0; --j) {
    const int first = pattern.begin(j), last = pattern.begin(j + 1);
    const Block& L_inverse = inverse_[static_cast<std::size_t>(j)];
    for (int e = first; e < last; ++e) {
      slot[static_cast<std::size_t>(pattern.row(e))] = e;
      W[static_cast<std::size_t>(e)] = below_[static_cast<std::size_t>(e)].template topRows<N>() * L_inverse;
    }
    // Z(i, j) = -sum over k of Z(i, k) W(k); rows i and k of one column have their block of Z in the pattern.
    for (int e = first; e < last; ++e) {
      const int k = pattern.row(e);
      Z_below[static_cast<std::size_t>(e)] -= Z_diagonal[static_cast<std::size_t>(k)] * W[static_cast<std::size_t>(e)];
      for (int f = pattern.begin(k); f < pattern.begin(k + 1); ++f) {
        const int at = slot[static_cast<std::size_t>(pattern.row(f))];
        if (at < first) continue;
        Z_below[static_cast<std::size_t>(at)] -= Z_below[static_cast<std::size_t>(f)] * W[static_cast<std::size_t>(e)];
        Z_below[static_cast<std::size_t>(e)] -= Z_below[static_cast<std::size_t>(f)].adjoint() * W[static_cast<std::size_t>(at)];
      }
    }
    Block& Z = Z_diagonal[static_cast<std::size_t>(j)];
    Z = L_inverse.adjoint() * L_inverse;
    for (int e = first; e < last; ++e) {
      Z -= W[static_cast<std::size_t>(e)].adjoint() * Z_below[static_cast<std::size_t>(e)];
      slot[static_cast<std::size_t>(pattern.row(e))] = -1;
    }
  }
  std::vector<Block> out(diagonal_.size());
  for (int v = 0; v < n; ++v) out[static_cast<std::size_t>(v)] = Z_diagonal[static_cast<std::size_t>(pattern.place(v))];
  return out;
}

}  // namespace modslam
