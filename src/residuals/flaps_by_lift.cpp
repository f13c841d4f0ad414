#include "residuals/samples.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include <pcor/numerics/noise.hpp>
#include <pcor/physics/air_data.hpp>
#include <pcor/physics/lift.hpp>
#include <pcor/regimes/regimes.hpp>
#include "numerics/decompositions.hpp"
#include "numerics/least_squares.hpp"
#include "numerics/median.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

constexpr double piece_time = 20.0;      // s
constexpr double time_in = 3600.0;       // s, mean duration
constexpr double time_out = 600.0;       // s, mean duration
constexpr double min_deficit = 0.12;     // a C-130 of 2004 showed 0.37 and more
constexpr double max_deficit = 0.8;      // and at most 0.68 before it landed
constexpr double outlier_share = 0.001;  // fraction of the pieces with flaps retracted whose deficit is wrong
constexpr double outlier_deficit = 0.3;  // their standard deviation
constexpr double slope_error = 0.05;     // relative error of the lift away from the fitted range
constexpr double usual_compression = -0.2;  // coefficient of M^2: half of the Prandtl-Glauert rule, as for
                                            // swept wings
constexpr double compression_spread = 0.3;  // standard deviation
constexpr double most_evidence = 3.0;       // ln 20
constexpr double over_speed = 0.05;         // standard deviation by which pilots exceed the limit
constexpr double likely = 0.9;
constexpr double robust_limit = 4.0;         // deviations
constexpr double sea_level_density = 1.225;  // kg/m3, standard atmosphere
constexpr std::size_t min_fast = 15;         // pieces
constexpr int lift_rounds = 10;

/// Means of 20 s.
struct Piece {
  std::size_t first = 0;  ///< sample
  std::size_t end = 0;
  double time = 0.0;  ///< s
  double lift = 0.0;  ///< n/q, 1/hPa
  double mach = 0.0;
  double angle = 0.0;     ///< recorded angle of attack
  double airspeed = 0.0;  ///< indicated airspeed from the mean dynamic pressure, m/s
  double weight = 0.0;    ///< its weight in the fit of the clean wing
  Estimate deficit{};     ///< relative deficit of the angle compared with the lift
  double out = 0.0;       ///< probability of flaps extended
};

double load_factor_at(const FlightSamples& samples, std::size_t i) {
  const std::vector<double>& climb = samples.motion.vertical_speed;
  const std::vector<double>& roll = samples.motion.roll;
  double acceleration = 0.0;
  if (!climb.empty()) {
    const std::size_t before = i - std::min<std::size_t>(i, 1);
    const std::size_t after = std::min(i + 1, climb.size() - 1);
    const double across = samples.time[after] - samples.time[before];
    acceleration = across <= 2.5 * samples.step ? (climb[after] - climb[before]) / across : nan;
  }
  return load_factor(acceleration, roll.empty() ? 0.0 : roll[i]);
}

std::vector<Piece> pieces_of(const FlightSamples& samples, const std::vector<double>& angle,
                             double min_airspeed) {
  const std::vector<double>& p = *samples.model.find(Quantity::static_pressure);
  const std::vector<double>& q = *samples.model.find(Quantity::dynamic_pressure);
  std::vector<Piece> pieces;
  for (std::size_t first = 0, end = 0; first < samples.time.size(); first = end) {
    Piece piece{first};
    double count = 0.0;
    double mean_q = 0.0;  // hPa
    while (end < samples.time.size() && samples.time[end] - samples.time[first] < piece_time) {
      const std::size_t i = end++;
      if (!(samples.motion.airspeed[i] >= min_airspeed) || !(q[i] > 0.0)) continue;
      const double mach = mach_number(p[i], q[i], dry_air<double>());
      const double lift = load_factor_at(samples, i) / q[i];
      if (!std::isfinite(lift) || !std::isfinite(angle[i])) continue;
      piece.time += samples.time[i];
      piece.lift += lift;
      piece.mach += mach;
      piece.angle += angle[i];
      mean_q += q[i];
      count += 1.0;
    }
    piece.end = end;
    if (2.0 * count * samples.step < piece_time) continue;
    for (double* const sum : {&piece.time, &piece.lift, &piece.mach, &piece.angle, &mean_q}) *sum /= count;
    piece.airspeed = std::sqrt(2.0 * 100.0 * mean_q / sea_level_density);
    pieces.push_back(piece);
  }
  return pieces;
}

/// angle = c0 + (c1 + c2 t + c3 M^2) n/q, with t in hours; c3/c1 has a prior, since one height does not
/// determine it.
class LiftLaw {
 public:
  explicit LiftLaw(const std::vector<Piece>& pieces)
      : middle_(0.5 * (pieces.front().time + pieces.back().time)) {
    std::vector<double> lifts;
    for (const Piece& piece : pieces) lifts.push_back(piece.lift);
    scale_ = median(std::move(lifts));
    Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    double lift = 0.0;
    double sum = 0.0;
    for (const Piece& piece : pieces) {
      const Eigen::Vector4d row = row_of(piece);
      information += piece.weight * row * row.transpose();
      right += piece.weight * piece.angle * row;
      lift += piece.weight * piece.lift;
      sum += piece.weight;
    }
    mean_lift_ = lift / sum;
    // First the usual compression alone, which gives slope and scatter; then its prior, in units of these.
    Eigen::Matrix4d precision = Eigen::Matrix4d::Zero();
    precision(3, 3) = information.trace();
    for (int pass = 0; pass < 2; ++pass) {
      const Eigen::Matrix4d inverse = pseudo_inverse(information + precision, 1e-9 * information.trace());
      coefficients_ = inverse * right;
      std::vector<double> clean;
      for (const Piece& piece : pieces) {
        if (piece.weight > 0.5) clean.push_back(departure(piece));
      }
      deviation_ = robust_standard_deviation(clean);
      const double variance = deviation_ * deviation_ * pieces_per_independent(clean);
      covariance_ = inverse * variance;
      const double spread = compression_spread * coefficients_[1];
      precision(3, 3) = variance / (spread * spread);
    }
  }

  bool rises() const { return coefficients_[1] > 0.0 && deviation_ > 0.0; }
  double deviation() const { return deviation_; }
  double departure(const Piece& piece) const { return piece.angle - row_of(piece).dot(coefficients_); }

  Estimate deficit(const Piece& piece) const {
    const Eigen::Vector4d row = row_of(piece);
    const double needed = row.tail<3>().dot(coefficients_.tail<3>());
    const double lever = slope_error * coefficients_[1] * (piece.lift - mean_lift_) / scale_;
    const double variance = deviation_ * deviation_ + row.dot(covariance_ * row) + lever * lever;
    return {-departure(piece) / needed, std::sqrt(variance) / needed};
  }

 private:
  /// With the usual compression in the slope, so that the last coefficient is the deviation from it.
  Eigen::Vector4d row_of(const Piece& piece) const {
    const double mach_squared = piece.mach * piece.mach;
    const double lift = piece.lift / scale_;
    const double slope = 1.0 + usual_compression * mach_squared;
    return {1.0, lift * slope, lift * slope * (piece.time - middle_) / 3600.0, lift * mach_squared};
  }

  /// Integrated autocorrelation time, in pieces, from the correlation of neighbours.
  double pieces_per_independent(std::vector<double> clean) const {
    constexpr double maximum = 0.95;
    double product = 0.0;
    double square = 0.0;
    for (double& each : clean) each = std::clamp(each, -3.0 * deviation_, 3.0 * deviation_);
    for (std::size_t i = 0; i < clean.size(); ++i) {
      square += clean[i] * clean[i];
      if (i > 0) product += clean[i] * clean[i - 1];
    }
    const double correlation = std::clamp(product / square, 0.0, maximum);
    return (1.0 + correlation) / (1.0 - correlation);
  }

  double middle_;  // s
  double scale_ = 1.0;
  double mean_lift_ = 0.0;
  double deviation_ = 0.0;
  Eigen::Vector4d coefficients_ = Eigen::Vector4d::Zero();
  Eigen::Matrix4d covariance_ = Eigen::Matrix4d::Zero();
};

double normal_density(double x, double deviation) {
  constexpr double root_of_two_pi = 2.5066282746310002;
  return std::exp(-0.5 * x * x / (deviation * deviation)) / (deviation * root_of_two_pi);
}

double normal_probability(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

/// Log likelihood ratio of flaps extended against flaps retracted, for a piece.
double evidence_of(const Piece& piece, double flap_speed) {
  const auto [value, error] = piece.deficit;
  const double in = (1.0 - outlier_share) * normal_density(value, error) +
                    outlier_share * normal_density(value, outlier_deficit);
  const double out = (normal_probability((value - min_deficit) / error) -
                      normal_probability((value - max_deficit) / error)) /
                     (max_deficit - min_deficit);
  const double by_lift = std::clamp(std::log(out) - std::log(in), -most_evidence, most_evidence);
  const double over = std::max(piece.airspeed / flap_speed - 1.0, 0.0) / over_speed;
  return (std::isnan(by_lift) ? 0.0 : by_lift) - 0.5 * over * over;
}

/// Finds the probability of the state out at each piece: forward and backward over all of them.
void find_probabilities(std::vector<Piece>& pieces, double flap_speed) {
  using States = Eigen::Vector2d;  // states: in, out
  const auto transition = [&pieces](std::size_t to) {
    const double time = pieces[to].time - pieces[to - 1].time;
    const double leaves_in = -std::expm1(-time / time_in);
    const double leaves_out = -std::expm1(-time / time_out);
    Eigen::Matrix2d matrix;
    matrix << 1.0 - leaves_in, leaves_in, leaves_out, 1.0 - leaves_out;
    return matrix;
  };
  const auto likelihood = [&](std::size_t i) {
    return States(1.0, std::exp(evidence_of(pieces[i], flap_speed)));
  };
  std::vector<States> forward(pieces.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const States before =
        i == 0 ? States(time_in, time_out) : States(transition(i).transpose() * forward[i - 1]);
    forward[i] = before.cwiseProduct(likelihood(i));
    forward[i] /= forward[i].sum();
  }
  States backward(1.0, 1.0);
  for (std::size_t i = pieces.size(); i-- > 0;) {
    const States both = forward[i].cwiseProduct(backward);
    pieces[i].out = both[1] / both.sum();
    if (i == 0) break;
    backward = transition(i) * likelihood(i).cwiseProduct(backward);
    backward /= backward.sum();
  }
}

}  // namespace

std::optional<FlapsByLift> find_flaps_by_lift(const FlightSamples& samples, const std::vector<double>& angle,
                                              double min_airspeed) {
  std::vector<Piece> pieces = pieces_of(samples, angle, min_airspeed);
  const double flap_speed = max_flap_speed(samples.aircraft);
  std::size_t fast = 0;
  for (Piece& piece : pieces) {
    if (!(piece.airspeed > flap_speed)) continue;
    piece.weight = 1.0;
    ++fast;
  }
  if (fast < min_fast) return {};
  for (int round = 0; round < lift_rounds; ++round) {
    const LiftLaw law(pieces);
    if (!law.rises()) return {};
    for (Piece& piece : pieces) piece.deficit = law.deficit(piece);
    find_probabilities(pieces, flap_speed);
    for (Piece& piece : pieces) {
      const double off = law.departure(piece) / (robust_limit * law.deviation());
      piece.weight = (1.0 - piece.out) / (1.0 + off * off);
    }
  }
  FlapsByLift flaps;
  flaps.out.resize(samples.time.size());
  std::vector<double> where_out;
  std::vector<double> where_in;
  const std::vector<double>& time = samples.time;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Piece& piece = pieces[i];
    const bool is_out = piece.out > likely;
    (is_out ? where_out : where_in).push_back(piece.deficit.value);
    if (!is_out) continue;
    // Samples next to a piece, for example in the first seconds after take-off, have its state.
    double begin = time[piece.first] - piece_time;
    double end = time[piece.end - 1] + piece_time;
    if (i > 0) begin = std::max(begin, 0.5 * (time[pieces[i - 1].end - 1] + time[piece.first]));
    if (i + 1 < pieces.size()) end = std::min(end, 0.5 * (time[piece.end - 1] + time[pieces[i + 1].first]));
    const auto first = std::lower_bound(time.begin(), time.end(), begin) - time.begin();
    const auto last = std::upper_bound(time.begin(), time.end(), end) - time.begin();
    for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(last); ++k)
      flaps.out[k] = samples.motion.airspeed[k] >= min_airspeed;
  }
  flaps.deficit = where_out.empty() ? 0.0 : median(std::move(where_out));
  flaps.deviation = robust_standard_deviation(std::move(where_in));
  return flaps;
}

}  // namespace pcor::internal
