#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <pcor/flight/flight_writer.hpp>
#include <pcor/realtime/loop.hpp>

namespace pcor::internal {

/// A derived variable: what of the loop's state it is, and its values that are not written yet.
struct Output {
  Quantity quantity = Quantity::count;
  double offset = 0.0;     ///< added to go from the library's unit to the file's
  std::size_t number = 0;  ///< of the writer's
  std::vector<double> values{};

  double value_in(const Loop& loop) const { return loop.state()[quantity] + offset; }
};

/// What leaves the loop as late as its filter is: filtered variables, and the quality bits, one of which the
/// filter sets of the same earlier sample. Brings them back to the samples that they are of.
class DelayLine {
 public:
  /// @param delay of the filter, samples
  explicit DelayLine(std::size_t delay) : delay_(delay) {}

  void add(Output filtered) { outputs_.push_back(std::move(filtered)); }
  void set_flags(std::size_t number) { flags_.number = number; }

  /// True where samples since the last gap are still in the filter.
  bool is_running() const { return runs_ > 0; }
  std::size_t delay() const { return delay_; }

  /// Takes the quality bits of a new sample, as a number and without that of the filter.
  void enter(double bits) { flags_.values.push_back(bits); }

  /// Takes what left the filter in the last run of the loop. True where the filter says that it had too
  /// little of its window.
  bool leave(const Loop& loop);

  /// After a gap the filter is empty.
  void reset() { runs_ = 0; }

  /// Writes the whole records of what has left the filter.
  void write(FlightWriter& writer, std::size_t rate);

 private:
  std::size_t delay_;
  std::vector<Output> outputs_;
  Output flags_;
  std::size_t runs_ = 0;      // of the loop since the last gap
  std::size_t finished_ = 0;  // samples that left the filter and are not written yet
  std::size_t written_records_ = 0;
};

}  // namespace pcor::internal
