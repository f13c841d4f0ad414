#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/flight/flight_writer.hpp>
#include <pcor/process/process.hpp>
#include <pcor/realtime/loop.hpp>
#include "model_io/output_table.hpp"
#include "process/delay_line.hpp"
#include "roles/fast_series.hpp"
#include "roles/find_frozen.hpp"
#include "roles/model_inputs.hpp"

namespace pcor::internal {

/// A variable of the file that the loop reads.
struct Input : ModelInput {
  std::vector<double> values{};  // values of one block
  RejectedCounts excluded{};     // total of all inputs
  std::vector<bool> frozen{};    // records in which the sensor is frozen; empty: none
};

/// One flight on its way through the loop.
class Processing {
 public:
  Processing(const std::filesystem::path& input, const ModelDefinition& file, const ProcessOptions& options)
      : flight_(input, options.timestamp_alignment), given_(file), file_(file), options_(options) {}

  ProcessSummary run(const std::filesystem::path& output);

 private:
  using Names = std::vector<std::string>;

  [[noreturn]] void fail(Error::Code code, const std::string& what) const {
    throw Error(code, flight_.path().string() + ": " + what);
  }
  [[noreturn]] void fail_model(const std::string& what) const {
    throw Error(Error::Code::model, fmt::format("model '{}': {}", file_.model.name, what));
  }

  template <class... Values>
  void note(fmt::format_string<const Values&...> format, const Values&... values) {
    summary_.notes.push_back(fmt::format(format, values...));
  }

  std::string notes_as_text() const {
    std::vector<std::string> texts;
    for (const Note& note : summary_.notes) texts.push_back(format_note(note));
    return fmt::format("{}", fmt::join(texts, "; "));
  }

  std::string to_string(const std::string& standard) const {
    return file_.output_name(standard) + options_.suffix;
  }

  void choose_roles();
  void choose_chain();
  void choose_inputs();
  void find_frozen_sensors();
  void find_flaps();
  std::string add_outside(const std::string& reason, const std::vector<bool>& records,
                          std::size_t max_gap = 0);
  void note_domain();
  void choose_rate();
  ShortestPeriods choose_periods();
  void leave_out_noise(Quantity rate, const SignalBand& band);
  ModelDefinition doubted() const;
  ModelUncertainty uncertainty();
  void note_archive();
  void note_uncertainty();
  bool states(std::initializer_list<EffectLocation> locations, std::initializer_list<Quantity> roles) const;
  FileDescription describe() const;
  void copy_variables(FlightWriter& writer, const FileDescription& description);
  Names dependencies_of(const OutputRow& row) const;
  void define_outputs(FlightWriter& writer);
  bool is_written(const OutputRow& row) const;
  std::string uncertainty_comment() const;
  void define_flags(FlightWriter& writer);
  std::size_t define(FlightWriter& writer, const OutputVariable& variable);
  void process_block(RecordBlock block, std::vector<double>& times);
  void note_sample();
  void remove_uncertainty_with_flaps();
  void take_results();
  void flush();
  std::string temperature_calibration();

  Flight flight_;
  const ModelDefinition& given_;
  ModelDefinition file_;  // model adapted to this flight
  const ProcessOptions& options_;
  std::vector<Quantity> roles_;
  std::shared_ptr<const Chain> chain_;
  std::optional<Loop> loop_;
  ModelUncertainty uncertainty_;  // uncertainty of the model and its inputs
  std::vector<Input> inputs_;
  std::optional<DelayLine> results_;
  std::optional<DelayLine> filtered_;  // later still; and the quality bits, one of which is the filter's
  double sample_step_ = 1.0;           // s
  std::vector<bool> frozen_;           // records in which any sensor is frozen; empty: none
  std::vector<bool> flaps_;            // records outside the law by extended flaps; empty: none
  std::vector<bool> outside_;          // records in flight outside the domain of the law; empty: none
  std::size_t noted_ = 0;              // samples of which results are available
  std::map<Quantity, std::string> output_names_;
  ProcessSummary summary_;
};

}  // namespace pcor::internal
