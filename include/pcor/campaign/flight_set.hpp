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

namespace internal {
class FlightPartition;
}

/// How the flights of a set are read.
struct FlightSetOptions {
  TimestampAlignment timestamp_alignment = TimestampAlignment::begin;
  Communicator* comm =
      &serial_communicator();  ///< the processes that share the flights; each reads its own ones
  /// Bytes of samples that a process keeps; samples beyond that are read again when they are needed, so the
  /// memory does not grow with the number of flights.
  std::size_t memory = std::size_t{512} << 20U;
};

/// What is known of a flight without its samples, in every process of the team.
struct FlightOutline {
  std::string aircraft{};       ///< as the file states it; may be empty
  std::string family{};         ///< of the names of its variables
  std::string time_variable{};  ///< empty for samples in memory
  std::string title{};          ///< project, number and date; the file name where the file states none
  double begin = 0.0;           ///< s since 1970 UTC

  template <class Archive>
  void serialize(Archive& archive) {
    archive(aircraft, family, time_variable, title, begin);
  }
};

/// The flights of one command: files, or samples in memory.
///
/// Every file is opened once and stays open; of more than 16 files those that were used last. The identity of
/// a file (device, inode, size, times of change) is taken when it is first opened and holds for the life of
/// the set: whatever reads a file that was replaced or changed since then throws, so results never mix two
/// versions. Samples are read once for each set of roles and kept while the memory lasts.
///
/// Copies of a set share all of that, and so do the sets that `only`, `part` and `with` make of it. A set is
/// for one thread, except `reserve` and `release`.
class FlightSet {
 public:
  FlightSet();  ///< no flight

  /// Nothing is opened yet. Paths convert to a set, so that `refit({"a.nc", "b.nc"}, ...)` works.
  FlightSet(const std::vector<std::filesystem::path>& paths, const FlightSetOptions& options = {});
  FlightSet(std::initializer_list<std::filesystem::path> paths);

  /// Samples in memory, which hold what the model and the reference read.
  FlightSet(const std::vector<std::shared_ptr<const FlightSamples>>& samples,
            const FlightSetOptions& options = {});
  FlightSet(std::initializer_list<std::shared_ptr<const FlightSamples>> samples);

  std::size_t size() const;
  bool empty() const { return size() == 0; }

  /// The file name of a flight; for samples in memory the name that they have.
  std::string name(std::size_t flight) const;
  /// Empty for samples in memory.
  const std::filesystem::path& path(std::size_t flight) const;
  std::vector<std::filesystem::path> paths() const;

  Communicator& comm() const { return *comm_; }
  const internal::FlightPartition& share() const { return *share_; }

  /// One flight, for this process alone.
  FlightSet only(std::size_t flight) const;
  /// So many of the flights, for the same team.
  FlightSet part(std::size_t first, std::size_t count) const;
  /// These flights, then those of another set of the same team.
  FlightSet with(const FlightSet& more) const;

  /// The open file of an own flight; the reference is valid until 16 other flights were asked for.
  /// @throws Error if it cannot be opened, was replaced or changed, or the flight is samples in memory.
  const Flight& operator[](std::size_t flight) const;

  /// What a model and a reference read of an own flight (`read_samples`); for samples in memory these.
  std::shared_ptr<const FlightSamples> samples(std::size_t flight, const ModelDefinition& model,
                                               const Reference& reference, const MaskOptions& mask) const;

  /// What every process knows of the flights: one exchange when it is first asked for.
  /// @throws Error that of the first flight that cannot be opened, by any process
  std::vector<FlightOutline> outlines() const;

  /// The names of the variables of each flight: one exchange. @throws Error as `outlines`
  std::vector<std::vector<std::string>> variables() const;

  /// "GOTEX rf06 2004-02-18 and 2 more", for the names of models. @throws Error as `outlines`
  std::string title() const;

  /// @throws Error that names two flights of different aircraft; or as `outlines`
  void require_one_aircraft() const;
  /// @throws Error that names a file that is given twice: its samples would count as if they were new
  void require_each_once() const;
  /// To be called when a result is complete. @throws Error that names a file that was replaced or changed
  /// since it was opened, by any process
  void require_unchanged() const;

  /// Takes so many bytes of the memory of the set for what is computed of its samples. False where they are
  /// not free; samples that nobody uses make room. To be given back with `release`. For any thread.
  bool reserve(std::size_t bytes) const;
  void release(std::size_t bytes) const;

 private:
  struct Entry;
  struct Memory;

  FlightSet(std::vector<std::shared_ptr<Entry>> entries, internal::FlightPartition share, Communicator& comm);

  std::vector<std::shared_ptr<Entry>> entries_{};
  std::shared_ptr<const internal::FlightPartition> share_;
  Communicator* comm_;
};

}  // namespace pcor
