#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <optional>
#include <vector>

#include <pcor/model_io/model_definition.hpp>
#include "diagnose/whitened_system.hpp"

namespace pcor::internal {

/// Three times the usual size of an effect is a standard deviation of its size in nature.
inline constexpr double spread_of_sizes = 3.0;

/// Columns that belong together: the tested parameters of one effect.
struct ColumnGroup {
  Eigen::Index first = 0;  ///< among the candidates' columns
  Eigen::Index count = 0;
  std::size_t effect = 0;        ///< groups of one effect, in several shapes, exclude each other
  std::vector<Bounds> bounds{};  ///< of each column's coefficient; an effect beyond them is impossible
  /// As large as each coefficient is met in practice; 0, or nothing, where nobody knows.
  std::vector<double> usual{};
  /// Columns of the uncertain shape, whose coefficients have a normal prior of variance 1; none before the
  /// effect was chosen.
  Eigen::Index shape_first = 0;
  Eigen::Index shape_count = 0;
  bool has_uncertain_shape = false;  ///< an effect of the flow; those of instruments have exact shapes

  /// Standard deviation of the size of a coefficient in nature; 0 where nobody knows.
  double deviation(std::size_t column) const {
    return column < usual.size() ? spread_of_sizes * usual[column] : 0.0;
  }
};

struct SearchOptions {
  std::size_t draws = 4000;
  double confidence = 0.997;          ///< with which no effect is found where there is none
  std::optional<double> threshold{};  ///< instead of the one by draws, and then without the gates
  std::size_t max_effects = 4;
  std::uint64_t seed = 1;
};

/// What a group would come to beside a set of others.
struct GroupScore {
  double chi2 = 0.0;
  double freedom = 0.0;     ///< directions that the base and the others leave
  double equivalent = 0.0;  ///< chi2 as if of one degree
  Eigen::VectorXd estimate{};
  Eigen::MatrixXd covariance{};
  bool possible = true;  ///< within the bounds, as far as the errors tell
};

struct SearchResult {
  std::vector<std::size_t> chosen{};  ///< groups, the strongest first
  double threshold = 0.0;
  std::vector<double> p_values{};  ///< of each chosen one
};

/// Which groups of columns explain residuals that the base cannot.
class Search {
 public:
  /// @param scores are kept by address; @param base how many of the scores' columns are the model's own; the
  /// rest are those of the groups
  Search(const WhitenedSystem& scores, Eigen::Index base, const std::vector<ColumnGroup>& groups);

  /// The part of a group's variance that the base leaves, of its best direction. 0 to 1.
  double remaining(std::size_t group) const { return remaining_[group]; }
  /// A group of which the base leaves nothing that could be seen is absorbed: it is not searched for.
  bool is_absorbed(std::size_t group) const { return turned_[group].cols() == 0; }

  /// The columns of a group that base and the group's other columns do not imitate, counted within it. The
  /// coefficients of the rest stay at zero.
  const std::vector<Eigen::Index>& told(std::size_t group) const { return told_[group]; }

  SearchResult run(const SearchOptions& options) const;

  /// The score of a group beside the others of a set (itself left out of it).
  GroupScore score(std::size_t group, const std::vector<std::size_t>& others) const;

  /// By how much the flights make a set of effects more likely than none: the logarithm of the ratio of the
  /// marginal likelihoods, in which the size of the noise and the coefficients are averaged over, the model's
  /// own with all sizes alike, those of the effects with sizes about the usual ones. An effect of ten times
  /// its usual size is not impossible, but needs more of the flights than a usual one (the tails are those of
  /// a mixture of normal distributions).
  ///
  /// @param with_shapes the shapes of effects of the flow are uncertain
  double evidence(const std::vector<std::size_t>& set, bool with_shapes = true) const;

  /// Of what base and `others` leave of two groups, the largest correlation, with sign where both have one
  /// column.
  double correlation(std::size_t a, std::size_t b, const std::vector<std::size_t>& others) const;

  /// Estimates and covariance of base and chosen columns together, in the order base, then the columns of
  /// the groups as given. What the flights hardly see of an effect has its usual size for an error.
  void fit(const std::vector<std::size_t>& chosen, Eigen::VectorXd& estimate,
           Eigen::MatrixXd& covariance) const;

  /// The variance of the whitened residuals after a fit of base and `chosen`; 1 where the noise model holds.
  double variance(const std::vector<std::size_t>& chosen) const;

  /// What is left of the whitened residuals of each own flight after a fit of base and `chosen`.
  std::vector<Eigen::VectorXd> left(const std::vector<std::size_t>& chosen) const;

  /// The rows of a group's best direction after base and others, of each own flight: where its evidence lies.
  std::vector<Eigen::VectorXd> leftover_rows(std::size_t group, const std::vector<std::size_t>& others) const;

 private:
  struct Conditional {
    Eigen::MatrixXd information;  // of all turned columns, given base and the set
    Eigen::VectorXd score;
    double squares = 0.0;
    double variance = 1.0;
  };

  Eigen::Index begin_of(std::size_t group) const { return begin_[group]; }
  std::vector<Eigen::Index> places_of(const std::vector<std::size_t>& groups) const;
  /// Columns of the uncertain shapes of a set, counted from the first candidate's.
  std::vector<Eigen::Index> shapes_of(const std::vector<std::size_t>& set) const;
  Conditional given(const std::vector<std::size_t>& groups) const;
  GroupScore score_in(const Conditional& conditional, std::size_t group) const;
  /// Turns each group's columns to unit length and right angles in the conditional information; columns
  /// without anything left become zero.
  Eigen::MatrixXd normal_turn(const Conditional& conditional, const std::vector<std::size_t>& groups,
                              std::vector<Eigen::Index>& freedom) const;
  double threshold_of(const Conditional& conditional, const std::vector<std::size_t>& groups,
                      const SearchOptions& options) const;
  /// What the score of a winner has to exceed: the threshold, more where it rests on a few minutes, or where
  /// the noise there is larger than elsewhere.
  double level(std::size_t winner, const std::vector<std::size_t>& chosen, double threshold) const;
  /// By minutes, the noise in the score of a group: what is left of it when its effect is taken off.
  Eigen::VectorXd own_noise(std::size_t group, const std::vector<std::size_t>& others) const;
  double effective_blocks(std::size_t group, const std::vector<std::size_t>& others) const;
  /// Gives each effect its first shape, that of the catalogue, where the flights do not tell another.
  void prefer_usual_shapes(std::vector<std::size_t>& chosen) const;
  /// Exchanges, joins and drops effects for as long as that makes the set more likely.
  void improve(std::vector<std::size_t>& chosen, double price) const;
  double log_ratio(const std::vector<Eigen::Index>& columns, const Eigen::VectorXd& precision) const;
  Eigen::VectorXd precision_of(std::size_t group, double times) const;
  bool is_taken(std::size_t group, const std::vector<std::size_t>& chosen) const;
  bool all_possible(const std::vector<std::size_t>& chosen) const;

  const WhitenedSystem* scores_;
  Eigen::Index base_;
  std::vector<ColumnGroup> groups_;
  Eigen::VectorXd scale_;  // of every column, to unit length
  std::vector<double> remaining_;
  std::vector<std::vector<Eigen::Index>> told_;
  std::vector<Eigen::MatrixXd> turned_;  // scaled columns of a group to its directions
  std::vector<Eigen::Index> begin_;      // of each group among the turned columns
  Eigen::MatrixXd left_;                 // information of scaled candidates after the base
  Eigen::VectorXd left_score_;
  Eigen::Index candidates_ = 0;  // columns of all groups; those of shapes follow
  Eigen::MatrixXd information_;  // the same of turned columns
  Eigen::VectorXd score_;
  double squares_ = 0.0;
};

}  // namespace pcor::internal
