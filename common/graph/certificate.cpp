// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/certificate.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <complex>

#include "common/graph/block_cholesky.hpp"

namespace modslam {
namespace {

using Complex = std::complex<double>;
using Block = Eigen::Matrix2cd;  // rows and columns: heading, position of a node
using Vector = Eigen::VectorXcd;
constexpr double kRelativeGap = 1e-6;
constexpr int kLanczosSteps = 40;
constexpr double kShareOfTurn = 0.8;

Complex complex(const Eigen::Vector2d& v) { return {v.x(), v.y()}; }

/// A large diag(along, along, turn) that an edge's information contains.
struct Isotropic {
  double along = 0, turn = 0;

  explicit Isotropic(const Eigen::Matrix3d& information) {
    const Eigen::Matrix2d P = information.topLeftCorner<2, 2>();
    const Eigen::Vector2d c = information.topRightCorner<2, 1>();
    Eigen::Matrix2d rest = P;
    turn = information(2, 2);
    if (c.norm() > 1e-9 * std::sqrt(P.trace() * turn)) {
      // What the edge says of the turn alone is shared: a part goes to the turn, the rest to the position.
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(P);
      const Eigen::Vector2d along_axes = eigen.eigenvectors().transpose() * c;
      double explained = 0;
      for (int k = 0; k < 2; ++k)
        if (eigen.eigenvalues()[k] > 1e-9 * P.trace()) explained += along_axes[k] * along_axes[k] / eigen.eigenvalues()[k];
      turn = std::max(kShareOfTurn * (information(2, 2) - explained), 0.0);
      rest -= c * c.transpose() / (information(2, 2) - turn);
    }
    const double half = 0.5 * rest.trace();
    along = std::max(half - std::hypot(0.5 * (rest(0, 0) - rest(1, 1)), rest(0, 1)), 0.0);
  }
};

/// The part of Q that one edge makes, with x = (r_from, t_from, r_to, t_to), and what is constant. See the header.
struct Minorant {
  Block from_from = Block::Zero(), to_to = Block::Zero(), from_to = Block::Zero();
  double constant = 0;

  Minorant(const GraphEdge& edge, const Eigen::Vector3d& e) {
    const Isotropic D(edge.information);
    const Complex w = complex(edge.T_from_to.translation()), z = std::polar(1.0, edge.T_from_to.heading);
    Eigen::Matrix3d N = edge.information;
    N.diagonal() -= Eigen::Vector3d(D.along, D.along, D.turn);
    const Eigen::Vector3d v = N * e;  // e' N e >= 2 v' e - e' N e, tangent at the given error
    constant -= e.dot(v);
    // Position: along |d - r_from w|^2 + 2 Re(conj(v) u) with u = conj(z) (conj(r_from) d - w), d = t_to - t_from.
    const Complex tangent = std::conj(complex(v.head<2>()) * z), pull = tangent - D.along * std::conj(w);
    constant -= 2 * (tangent * w).real();
    from_from(0, 0) += D.along * std::norm(w);
    from_from(1, 1) += D.along;
    to_to(1, 1) += D.along;
    from_to(1, 1) -= D.along;
    from_to(0, 1) += pull;
    from_from(0, 1) -= pull;
    from_from(1, 0) -= std::conj(pull);
    // Turn: k a^2 + 2 v a = k (a + s)^2 - k s^2, and k b^2 >= k b0^2 - C cos(b) + C cos(b0) with C = 2 k b0 / sin(b0) for |b0| < pi.
    if (!(D.turn > 0)) {
      constant -= 2 * kPi * std::abs(v[2]);  // a turn has no more than half a circle
      return;
    }
    const double s = v[2] / D.turn, b = e[2] + s;
    if (std::abs(b) >= kPi) {
      constant -= D.turn * s * s;
      return;
    }
    const double C = std::abs(b) < 1e-4 ? 2 * D.turn : 2 * D.turn * b / std::sin(b);
    constant += D.turn * (b * b - s * s) + C * std::cos(b);
    from_to(0, 0) -= 0.5 * C * std::polar(1.0, s) * std::conj(z);
  }
};

class Problem {
 public:
  explicit Problem(const PoseGraph& graph);
  /// Cholesky factor of Q - L + shift on the headings. @return whether there is one.
  bool factorize(double shift);
  /// Smallest eigenvalue of the Schur complement, by Lanczos on the inverse; needs a factor.
  double min_eigenvalue(double shift) const;
  double value() const { return value_; }
  double headings() const { return static_cast<double>(pattern_.variables()); }
  double scale() const { return scale_; }

 private:
  static std::vector<BlockPattern::Link> links_of(const PoseGraph& graph);

  BlockPattern pattern_;
  BlockCholesky<Complex, 2> factor_;
  std::vector<Block> diagonal_;
  struct Below {
    int entry;
    Block block;
  };
  std::vector<Below> below_;
  double value_ = 0, scale_ = 0;  // sum of the multipliers and of what is constant; the largest entry
};

std::vector<BlockPattern::Link> Problem::links_of(const PoseGraph& graph) {
  std::vector<BlockPattern::Link> links;
  for (const GraphEdge& edge : graph.edges) links.emplace_back(static_cast<int>(edge.from), static_cast<int>(edge.to));
  return links;
}

Problem::Problem(const PoseGraph& graph)
    : pattern_(static_cast<int>(graph.poses.size()), links_of(graph)), factor_(pattern_), diagonal_(graph.poses.size(), Block::Zero()) {
  std::vector<Complex> Qx(graph.poses.size());  // rows of headings
  const auto r = [&](std::size_t k) { return std::polar(1.0, graph.poses[k].heading); };
  const Eigen::Vector2d t_0 = graph.poses[0].translation();
  const auto t = [&](std::size_t k) { return complex(graph.poses[k].translation() - t_0); };
  for (const GraphEdge& edge : graph.edges) {
    const auto i = static_cast<std::size_t>(edge.from), j = static_cast<std::size_t>(edge.to);
    Minorant q(edge, edge_error(edge, graph.poses[i], graph.poses[j]));
    const Eigen::Vector2cd xi(r(i), t(i)), xj(r(j), t(j));
    const Eigen::Vector2cd yi = q.from_from * xi + q.from_to * xj, yj = q.to_to * xj + q.from_to.adjoint() * xi;
    Qx[i] += yi[0];
    Qx[j] += yj[0];
    value_ += q.constant;
    // Position 0 is nobody's choice: moving all poses together changes nothing.
    if (i == 0) q.from_to.row(1).setZero();
    if (j == 0) q.from_to.col(1).setZero();
    diagonal_[i] += q.from_from;
    diagonal_[j] += q.to_to;
    const int p = pattern_.place(static_cast<int>(i)), s = pattern_.place(static_cast<int>(j));
    below_.push_back({pattern_.entry(std::max(p, s), std::min(p, s)), p > s ? Block(q.from_to) : Block(q.from_to.adjoint())});
  }
  diagonal_[0](0, 1) = diagonal_[0](1, 0) = 0;
  diagonal_[0](1, 1) = 1;
  for (std::size_t k = 0; k < diagonal_.size(); ++k) {
    scale_ = std::max(scale_, std::abs(diagonal_[k](0, 0)));
    const double multiplier = (std::conj(r(k)) * Qx[k]).real();
    diagonal_[k](0, 0) -= multiplier;
    value_ += multiplier;
  }
}

bool Problem::factorize(double shift) {
  factor_.clear();
  for (std::size_t k = 0; k < diagonal_.size(); ++k) {
    factor_.diagonal(static_cast<int>(k)) = diagonal_[k];
    factor_.diagonal(static_cast<int>(k))(0, 0) += shift;
  }
  for (const Below& below : below_) factor_.add_below(below.entry, below.block);
  return factor_.factorize(false);
}

double Problem::min_eigenvalue(double shift) const {
  const Eigen::Index n = pattern_.variables();
  const auto inverse_on_headings = [&](const Vector& v) {
    Vector b = Vector::Zero(2 * n);
    for (Eigen::Index k = 0; k < n; ++k) b[2 * k] = v[k];
    const Vector x = factor_.solve(b);
    Vector out(n);
    for (Eigen::Index k = 0; k < n; ++k) out[k] = x[2 * k];
    return out;
  };
  const int steps = static_cast<int>(std::min<Eigen::Index>(kLanczosSteps, n));
  std::vector<Vector> basis{Vector(n)};
  for (Eigen::Index k = 0; k < n; ++k) basis[0][k] = std::polar(1.0, 2.4 * static_cast<double>(k) * static_cast<double>(k));
  basis[0].normalize();
  Eigen::MatrixXd T = Eigen::MatrixXd::Zero(steps, steps);
  int made = 0;
  for (int k = 0; k < steps; ++k) {
    Vector v = inverse_on_headings(basis.back());
    T(k, k) = basis.back().dot(v).real();
    ++made;
    for (int twice = 0; twice < 2; ++twice)
      for (const Vector& q : basis) v -= q * q.dot(v);
    const double length = v.norm();
    if (k + 1 == steps || length < 1e-12 * std::abs(T(k, k))) break;
    T(k, k + 1) = T(k + 1, k) = length;
    basis.push_back(v / length);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(T.topLeftCorner(made, made), Eigen::EigenvaluesOnly);
  return 1 / eigen.eigenvalues()[made - 1] - shift;
}

}  // namespace

Certificate certify(const PoseGraph& graph) {
  Certificate certificate;
  certificate.chi2 = graph_chi2(graph);
  if (graph.poses.size() < 2 || graph.edges.empty()) {
    certificate.is_optimal = certificate.chi2 == 0;
    return certificate;
  }
  Problem problem(graph);
  const double tolerance = kRelativeGap * certificate.chi2 + 1e-12 * problem.scale();
  double shift = tolerance / problem.headings();
  bool found = problem.factorize(shift);
  certificate.is_optimal = found && problem.value() > certificate.chi2 - tolerance;
  while (!found && shift < 1e3 * problem.scale()) found = problem.factorize(shift *= 10);
  if (!found) return certificate;
  certificate.min_eigenvalue = problem.min_eigenvalue(shift);
  certificate.lower_bound = std::max(problem.value() - shift * problem.headings(), 0.0);
  return certificate;
}

}  // namespace modslam
