#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include <pcor/flight/flight_writer.hpp>
#include <pcor/realtime/loop.hpp>

namespace pcor::internal {

/// A derived variable: what of the loop's state it is, and its values that are not written yet.
struct Output {
  Quantity quantity = Quantity::count;
  double offset = 0.0;     ///< added to go from the library's unit to the file's
  std::size_t number = 0;  ///< index in the writer
  std::vector<double> values{};
};

/// Assigns delayed outputs of the loop to their samples.
class DelayLine {
 public:
  /// @param delay in runs of the loop
  explicit DelayLine(std::size_t delay) : delay_(delay) {}

  void add(Output output) { outputs_.push_back(std::move(output)); }
  void set_flags(std::size_t number) { flags_ = Output{Quantity::count, 0.0, number, {}}; }

  /// Samples since the last gap without results yet.
  std::size_t inside() const { return entered_ - left_; }

  /// A sample enters the loop, which is then run.
  void enter() { ++entered_; }

  /// The quality bits, as a number, of the next sample of which they are known; it may leave later.
  void enter_flags(double bits) { flags_->values.push_back(bits); }
  /// Adds a bit of the sample with the latest results.
  void add_flag(double bit) { flags_->values[finished_ - 1] += bit; }

  /// Takes the results of the last run of the loop. False if they belong to no sample.
  bool leave(const Loop& loop) {
    if (++runs_ <= delay_ || left_ == entered_) return false;
    for (Output& output : outputs_) output.values.push_back(loop.state()[output.quantity] + output.offset);
    ++left_;
    ++finished_;
    return true;
  }

  /// After a gap nothing is in the loop.
  void reset() { runs_ = entered_ = left_ = 0; }

  /// Writes the complete records of delayed outputs.
  void write(FlightWriter& writer, std::size_t rate) {
    const RecordBlock block{written_records_, finished_ / rate};
    const auto samples = static_cast<std::ptrdiff_t>(block.count * rate);
    const auto write_one = [&](Output& output) {
      writer.write(output.number, block, output.values.data());
      output.values.erase(output.values.begin(), output.values.begin() + samples);
    };
    for (Output& output : outputs_) write_one(output);
    if (flags_) write_one(*flags_);
    finished_ -= static_cast<std::size_t>(samples);
    written_records_ += block.count;
  }

 private:
  std::size_t delay_;
  std::vector<Output> outputs_;
  std::optional<Output> flags_;
  std::size_t runs_ = 0;  // since the last gap
  std::size_t entered_ = 0;
  std::size_t left_ = 0;
  std::size_t finished_ = 0;  // samples with results that are not written yet
  std::size_t written_records_ = 0;
};

}  // namespace pcor::internal
