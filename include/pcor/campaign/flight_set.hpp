#pragma once

#include <pcor/flight/flight.hpp>
#include <pcor/parallel/communicator.hpp>
#include <pcor/residuals/reference.hpp>
#include <pcor/residuals/samples.hpp>

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

namespace pcor {

class FlightPartition;  // defined in src/parallel

/// Options for reading the flights of a set.
struct FlightSetOptions {
  TimestampAlignment timestamp_alignment = TimestampAlignment::begin;
  /// Processes that share the flights; each reads the flights of its partition.
  Communicator* comm = &serial_communicator();
  /// Maximum memory for samples per process, bytes; further samples are read again when needed, so memory
  /// does not depend on the number of flights.
  std::size_t memory = std::size_t{512} << 20U;
};

/// Information on a flight without its samples, available on every rank.
struct FlightOutline {
  std::string aircraft{};       ///< stated in the file; may be empty
  std::string naming{};         ///< naming convention of its variables
  std::string time_variable{};  ///< empty for samples in memory
  std::string title{};          ///< project, number and date; otherwise the file name
  double begin = 0.0;           ///< s since 1970 UTC

  template <class Archive>
  void serialize(Archive& archive) {
    archive(aircraft, naming, time_variable, title, begin);
  }
};

/// Flights of one command: files, or samples in memory.
///
/// Every file is opened once and stays open; of more than 16 files the last used ones. The identity of a file
/// (device, inode, size, times of change) is recorded when it is first opened; every later access to a
/// replaced or changed file throws, so results never mix two versions. Samples are read once for each set of
/// roles and kept within the memory limit.
///
/// Copies of a set share this state, and so do the sets returned by `only`, `part` and `with`. Not
/// thread-safe.
class FlightSet {
 public:
  FlightSet();  ///< no flight

  /// Opens no file yet. Paths convert to a set, so that `refit({"a.nc", "b.nc"}, ...)` works.
  FlightSet(const std::vector<std::filesystem::path>& paths, const FlightSetOptions& options = {});
  FlightSet(std::initializer_list<std::filesystem::path> paths);

  /// Samples in memory, with the variables of the model and the reference.
  FlightSet(const std::vector<std::shared_ptr<const FlightSamples>>& samples,
            const FlightSetOptions& options = {});
  FlightSet(std::initializer_list<std::shared_ptr<const FlightSamples>> samples);

  std::size_t size() const;
  bool empty() const { return size() == 0; }

  /// File name of a flight, or the name of samples in memory.
  std::string name(std::size_t flight) const;
  /// Path of a flight; empty for samples in memory.
  const std::filesystem::path& path(std::size_t flight) const;

  Communicator& comm() const { return *comm_; }
  const FlightPartition& partition() const { return *partition_; }

  /// Set of one flight, for this process only.
  FlightSet only(std::size_t flight) const;
  /// Subset of consecutive flights, for the same ranks.
  FlightSet part(std::size_t first, std::size_t count) const;
  /// Set of these flights followed by those of another set of the same ranks.
  FlightSet with(const FlightSet& more) const;

  /// Open file of a local flight; the reference is valid until 16 other flights have been requested.
  /// @throws Error if it cannot be opened, was replaced or changed, or the flight is samples in memory.
  const Flight& operator[](std::size_t flight) const;

  /// Inputs of a model and a reference for a local flight (`read_samples`); samples in memory are returned
  /// unchanged.
  std::shared_ptr<const FlightSamples> samples(std::size_t flight, const ModelDefinition& model,
                                               const Reference& reference, const MaskOptions& mask) const;

  /// Outlines of all flights, on every rank. The first call is collective.
  /// @throws Error of the first flight that cannot be opened, on every rank
  std::vector<FlightOutline> outlines() const;

  /// Names of the variables of each flight, on every rank. Every call is collective. @throws Error as
  /// `outlines`, or if the flight is samples in memory
  std::vector<std::vector<std::string>> variables() const;

  /// Title for models, e.g. "GOTEX rf06 2004-02-18 and 2 more". @throws Error as `outlines`
  std::string title() const;

  /// @throws Error with two flights of different aircraft; or as `outlines`
  void require_one_aircraft() const;
  /// @throws Error with a file that is listed twice: its samples would count twice
  void require_each_once() const;
  /// Check at the end of a computation. @throws Error, on every rank, with a file that was replaced or
  /// changed since it was opened
  void require_unchanged() const;

 private:
  struct Entry;
  struct Memory;

  FlightSet(std::vector<std::shared_ptr<Entry>> entries, FlightPartition partition, Communicator& comm);

  std::vector<std::shared_ptr<Entry>> entries_{};
  std::shared_ptr<const FlightPartition> partition_;
  Communicator* comm_;
};

}  // namespace pcor
