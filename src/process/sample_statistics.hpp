#pragma once

#include <vector>

#include <pcor/process/process.hpp>
#include <pcor/realtime/chain.hpp>

namespace pcor::internal {

/// Statistics of the samples of a flight: adds up the counts and the delta-p of a `ProcessSummary`.
class SampleStatistics {
 public:
  /// @param states_defect_error whether the uncertainty of delta-p is stated
  /// @param summary has the rate, the numbers of records and samples, and the dynamic pressure of flight
  SampleStatistics(const Chain& chain, bool states_defect_error, ProcessSummary& summary);

  /// Adds the results of the next sample, and returns its quality bits as a number: all of `quality` but
  /// `filter_window_incomplete`, which belongs to an earlier sample.
  double add(const State<double>& state, QualityFlags quality);

  /// Counts one sample with a bit that is known later.
  void count(Quality bit);

  std::size_t record_of_next() const { return next_ / static_cast<std::size_t>(summary_.rate); }

  /// Records in flight outside the domain of the law; empty without such records.
  const std::vector<bool>& outside_domain() const { return outside_; }

  /// "5 of 400 samples could be corrected; most frequent reason: ...", if these are fewer than 1 %, otherwise
  /// empty.
  std::string uncorrected_text() const;

  /// After the last sample: computes the means, and warns if delta-p is less certain than the errors that a
  /// correction removes.
  void finish();

  /// Warns of a thermometer whose values give no possible temperature in most samples, as in a wrong unit.
  void note_impossible_temperature(const ModelDefinition& model);

 private:
  const Chain& chain_;
  bool states_defect_error_;
  ProcessSummary& summary_;
  Quantity thermometer_;
  std::size_t next_ = 0;                     // number of samples so far
  std::vector<bool> outside_{};              // records
  std::size_t impossible_temperatures_ = 0;  // corrected samples whose thermometer gives no temperature
  double sum_of_impossible_ = 0.0;           // sum of the thermometer values in these samples, K
  std::size_t uncertain_samples_ = 0;        // samples in flight with an uncertainty of delta-p
  double sum_of_uncertainties_ = 0.0;        // hPa
};

}  // namespace pcor::internal
