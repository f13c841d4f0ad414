#include "process/delay_line.hpp"

namespace pcor::internal {

bool DelayLine::leave(const Loop& loop) {
  if (++runs_ <= delay_ || left_ == entered_) return false;
  for (Output& output : outputs_) output.values.push_back(output.value_in(loop));
  ++left_;
  ++finished_;
  return true;
}

void DelayLine::write(FlightWriter& writer, std::size_t rate) {
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

}  // namespace pcor::internal
