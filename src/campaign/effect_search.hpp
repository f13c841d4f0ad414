#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <pcor/model_io/model_definition.hpp>
#include "campaign/candidate.hpp"
#include "campaign/maximum_score.hpp"
#include "campaign/whitened.hpp"

namespace pcor::internal {

/// Columns that belong together: the tested parameters of one effect.
struct ColumnGroup {
  Eigen::Index first = 0;  ///< index among the candidates' columns
  Eigen::Index count = 0;
  std::size_t effect = 0;        ///< groups of one effect, in several shapes, exclude each other
  std::size_t system = 0;        ///< system on which the effect is: 0 for the model's own
  std::vector<Bounds> bounds{};  ///< coefficient of each column; an effect beyond them is impossible
  /// Usual size of each coefficient; 0 or empty if unknown.
  std::vector<double> typical{};
  /// An effect clearly beyond this number of typical sizes has another cause.
  double max_relative_size = std::numeric_limits<double>::infinity();
  /// Columns of the uncertain shape, whose coefficients have a normal prior of variance 1; empty before the
  /// effect was chosen.
  Eigen::Index shape_first = 0;
  Eigen::Index shape_count = 0;
  /// True for effects of the flow; effects of instruments have exact shapes.
  bool has_uncertain_shape = false;

  /// Standard deviation of the size of a coefficient in nature; 0 if unknown.
  double deviation(std::size_t column) const {
    return column < typical.size() ? spread_of_sizes * typical[column] : 0.0;
  }
};

/// A set of groups with one more, and without one of them.
inline std::vector<std::size_t> set_with(std::vector<std::size_t> set, std::size_t group) {
  set.push_back(group);
  return set;
}
std::vector<std::size_t> set_without(std::vector<std::size_t> set, std::size_t group);

/// Columns of a group among those of base and candidates.
std::vector<Eigen::Index> indices_of(const ColumnGroup& group, Eigen::Index base);

/// Columns of the base, then of some groups, among those of base and candidates.
std::vector<Eigen::Index> indices_of(const std::vector<std::size_t>& some,
                                     const std::vector<ColumnGroup>& groups, Eigen::Index base);

/// Squares of `columns` with these coefficients after the columns `rest`.
/// @param information products of all columns with each other
double distinct_squares(const Eigen::MatrixXd& information, const std::vector<Eigen::Index>& rest,
                        const std::vector<Eigen::Index>& columns, const Eigen::VectorXd& coefficients);

/// Seed of the random draws of a diagnosis, which set its thresholds.
inline constexpr std::uint64_t random_seed = 20120106;

struct SearchOptions {
  std::size_t draws = 4000;
  double confidence = 0.997;          ///< probability of no finding if there is no effect
  std::optional<double> threshold{};  ///< replaces the threshold from draws and disables the gates
  std::size_t max_effects = 4;
  std::uint64_t seed = 1;
  std::vector<std::size_t> references{};  ///< reference of each flight; empty: one for all
};

/// Standard deviation of the widest prior of an effect, in typical sizes.
inline constexpr double widest_prior = 10.0;

/// Score of a group in addition to a set of others.
struct GroupScore {
  double chi2 = 0.0;
  double degrees_of_freedom = 0.0;  ///< directions not explained by base and others
  double chi2_one_dof = 0.0;        ///< equivalent chi2 of one degree of freedom
  Eigen::VectorXd estimate{};
  Eigen::MatrixXd covariance{};
  bool possible = false;  ///< the estimate is within its bounds, given the errors
};

struct SearchResult {
  std::vector<std::size_t> chosen{};  ///< groups sorted by decreasing evidence
  double threshold = 0.0;
  std::vector<double> p_values{};  ///< one per chosen group
};

/// Estimates and covariance of base and chosen columns together, in the order of `indices_of`.
struct SearchFit {
  Eigen::VectorXd estimate{};
  Eigen::MatrixXd covariance{};
};

/// Search for groups of columns that explain residuals beyond the base.
class EffectSearch {
 public:
  /// @param scores are kept by address; @param base number of the scores' columns that belong to the model;
  /// the rest are those of the groups
  EffectSearch(const WhitenedSystem& scores, Eigen::Index base, const std::vector<ColumnGroup>& groups);

  /// Fraction of the variance of a group's best direction that the base leaves, 0 to 1.
  double remaining(std::size_t group) const { return remaining_[group]; }
  /// Fraction of the variance of a group with these coefficients that the base leaves, 0 to 1.
  double remaining(std::size_t group, const Eigen::VectorXd& coefficients) const;
  /// Absorbed groups, with no visible remainder after the base, are not searched for.
  bool is_absorbed(std::size_t group) const { return turned_[group].cols() == 0; }

  /// Columns of a group that the base and the group's other columns do not imitate, counted within the group.
  /// The other coefficients stay zero.
  const std::vector<Eigen::Index>& identifiable(std::size_t group) const { return identifiable_[group]; }

  SearchResult run(const SearchOptions& options) const;

  /// Score of a group in addition to the others of a set (the group itself excluded).
  GroupScore score(std::size_t group, const std::vector<std::size_t>& others) const;

  /// Log ratio of the marginal likelihood of a set of effects to that of the empty set. The noise level and
  /// the coefficients are integrated out: flat prior for model coefficients, typical sizes for effects. An
  /// effect of ten times its typical size is possible but needs more evidence (the tails are those of a
  /// mixture of normal distributions).
  ///
  /// @param uncertain effects whose uncertain shapes are part of the set
  double evidence(const std::vector<std::size_t>& set, const std::vector<std::size_t>& uncertain) const;
  double evidence(const std::vector<std::size_t>& set) const { return evidence(set, set); }

  /// Largest correlation between two groups after base and `others`; signed if both have one column.
  double correlation(std::size_t a, std::size_t b, const std::vector<std::size_t>& others) const;

  /// Coefficients that the flights hardly constrain have their typical size as error.
  SearchFit fit(const std::vector<std::size_t>& chosen) const;

  /// Variance of the whitened residuals after a fit of base and `chosen`; 1 if the noise model holds.
  double variance(const std::vector<std::size_t>& chosen) const { return given(chosen).variance; }

  /// Whitened residuals of each local flight after a fit of base and `chosen`.
  std::vector<Eigen::VectorXd> residuals_after(const std::vector<std::size_t>& chosen) const;

  /// Rows of a group's best direction after base and others, for each local flight: the location of its
  /// evidence.
  std::vector<Eigen::VectorXd> rows_after(std::size_t group, const std::vector<std::size_t>& others) const;

 private:
  struct Conditional {
    Eigen::MatrixXd information;  // all rotated columns, given base and the set
    Eigen::VectorXd score;
    double squares = 0.0;
    double variance = 1.0;
  };

  /// Columns of the uncertain shapes of a set, counted from the first candidate's.
  std::vector<Eigen::Index> shapes_of(const std::vector<std::size_t>& set) const;
  Conditional given(const std::vector<std::size_t>& groups) const;
  GroupScore score_in(const Conditional& conditional, std::size_t group) const;
  /// Makes each group's columns orthonormal in the conditional information; directions without a remainder
  /// become zero.
  Eigen::MatrixXd normal_turn(const Conditional& conditional, const std::vector<std::size_t>& groups,
                              std::vector<Directions>& directions) const;
  double threshold_of(const Conditional& conditional, const std::vector<std::size_t>& groups,
                      const SearchOptions& options) const;
  /// Score that a winner must exceed: the threshold, raised if the evidence is in a few minutes or if the
  /// noise there is larger than elsewhere.
  double level(std::size_t winner, const std::vector<std::size_t>& chosen, double threshold) const;
  /// Gives each effect its shape of the catalogue (the first), unless the flights support another.
  void prefer_usual_shapes(std::vector<std::size_t>& chosen) const;
  /// Exchanges, joins and drops effects while the set becomes more likely.
  void improve(std::vector<std::size_t>& chosen, double price) const;
  /// First effect that is smaller than 2 % of a stronger one in the references that see it; the end if there
  /// is no such effect. The search is linear about the model, and finds it after the stronger one is in the
  /// model.
  std::vector<std::size_t>::iterator first_error_of_linearity(const std::vector<std::size_t>& references,
                                                              std::vector<std::size_t>& chosen) const;
  double log_ratio(const std::vector<Eigen::Index>& columns, const Eigen::VectorXd& precision) const;
  Eigen::VectorXd precision_of(std::size_t group, double times) const;
  bool is_taken(std::size_t group, const std::vector<std::size_t>& chosen) const;
  bool all_possible(const std::vector<std::size_t>& chosen) const;

  const WhitenedSystem* scores_;
  Eigen::Index base_;
  std::vector<ColumnGroup> groups_;
  Eigen::VectorXd scale_;  // scale of every column to unit length
  std::vector<double> remaining_;
  std::vector<std::vector<Eigen::Index>> identifiable_;
  std::vector<Eigen::MatrixXd> turned_;  // scaled columns of a group to its directions
  std::vector<Eigen::Index> begin_;      // first turned column of each group
  Eigen::MatrixXd scaled_information_;   // information of scaled candidates after the base
  Eigen::VectorXd scaled_score_;
  Eigen::Index candidates_ = 0;  // columns of all groups; columns of shapes follow
  Eigen::MatrixXd information_;  // information of turned columns after the base
  Eigen::VectorXd score_;
  double squares_ = 0.0;
};

}  // namespace pcor::internal
