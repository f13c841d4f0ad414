#pragma once

#include <pcor/parallel/communicator.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <typeinfo>
#include <utility>
#include <vector>

#include "parallel/digest.hpp"
#include "parallel/serialization.hpp"
#include "parallel/workers.hpp"

namespace pcor {

/// Flights of a list that each rank owns: no other rank reads them or keeps data of them.
class FlightPartition {
 public:
  /// All flights belong to one rank.
  explicit FlightPartition(std::size_t flights);

  /// Flights by decreasing size, each to the rank with the least to read.
  /// @param sizes of the flights, in bytes or any measure proportional to their work; identical on all ranks
  FlightPartition(Communicator& comm, const std::vector<std::uint64_t>& sizes);

  std::size_t flights() const { return owner_.size(); }
  bool is_local(std::size_t flight) const { return owner_[flight] == comm_->rank(); }
  std::size_t local_count() const {
    return static_cast<std::size_t>(std::count(owner_.begin(), owner_.end(), comm_->rank()));
  }
  Communicator& comm() const { return *comm_; }
  /// Threads of this rank for work on its flights.
  std::size_t threads() const { return internal::Workers(*comm_, 0).threads; }

  /// The partition of a list whose entries are each of one of these flights, as is a flight against one of
  /// several references: an entry is of the owner of its flight.
  FlightPartition of_entries(const std::vector<std::size_t>& flight_of_each) const;

  /// These flights, then those of another partition of the same communicator.
  FlightPartition with(const FlightPartition& more) const;
  FlightPartition part(std::size_t first, std::size_t count) const;

  /// Work on the flights of this rank. If it fails, all ranks fail at their next exchange.
  void attempt(const std::function<void()>& work) const;

  /// Results of all flights, in their order, on every rank: one exchange.
  /// @param visit gets the list of all parts, and sets the parts of the flights of this rank
  /// @param state on which the ranks must agree
  /// @throws Error of the first flight that failed, on any rank
  template <class Part>
  std::vector<Part> all_gather_parts(const std::function<void(std::vector<Part>&)>& visit,
                                     std::uint64_t state = 0) const {
    std::vector<Part> parts(flights());
    attempt([&] { visit(parts); });
    if (comm_->size() > 1)
      gather(
          [&parts](std::size_t flight) {
            const Part part = std::move(parts[flight]);
            return internal::serialized(part);
          },
          internal::digest_of(typeid(Part).name(), state + flights()),
          [&parts](std::size_t flight, internal::Deserializer& rank) { parts[flight] = rank.next<Part>(); });
    return parts;
  }

  /// Visits the flights of this rank in threads.
  /// @param prepare returns the work on a flight; it is called in this thread, in the order of the flights,
  /// and up to `threads` threads do the work
  /// @throws Error of the first flight that failed, with its number for `attempt`
  void visit(std::size_t threads,
             const std::function<std::function<void()>(std::size_t flight)>& prepare) const;

  /// Like `all_gather_flights`, from the content of each flight. @param read returns the content of a flight;
  /// it is called in this thread, in the order of the flights
  /// @param make returns the part of a flight from its number and content; up to `threads` threads call it
  template <class Part, class Read, class Make>
  std::vector<Part> map(std::size_t threads, const Read& read, const Make& make) const {
    return all_gather_parts<Part>([&](std::vector<Part>& parts) {
      visit(threads, [&](std::size_t flight) {
        return [&, flight, input = std::make_shared<decltype(read(flight))>(read(flight))] {
          auto content = std::move(*input);  // freed with the work, before the part is gathered
          parts[flight] = make(flight, std::move(content));
        };
      });
    });
  }

  /// Gathers parts of flights. @param make returns the part of a flight; it is called by up to `threads`
  /// threads
  template <class Part, class Make>
  std::vector<Part> all_gather_flights(const Make& make, std::uint64_t state = 0,
                                       std::size_t threads = 1) const {
    static_assert(!std::is_same_v<Part, bool>, "elements of std::vector<bool> share words between threads");
    return all_gather_parts<Part>(
        [&](std::vector<Part>& parts) {
          visit(threads, [&](std::size_t flight) { return [&, flight] { parts[flight] = make(flight); }; });
        },
        state);
  }

  /// The sum of the parts of all flights, added in their order, on every rank: some at a time are made and
  /// gathered, so that many need no more memory. @param make gives the part of a flight, which has a +=; it
  /// is called by up to `threads` threads, a number that is equal on all ranks
  template <class Part, class Make>
  Part all_reduce_flights(const Make& make, std::size_t threads = 1) const {
    // Few enough to be kept in memory, enough that ranks with unequal work rarely wait.
    constexpr std::size_t of_each = 4, enough = 64;
    const std::size_t workers = comm_->size() * threads;
    const std::size_t at_a_time = std::min(of_each * workers, std::max(enough, workers));
    Part sum{};
    for (std::size_t first = 0; first < flights(); first += at_a_time) {
      const FlightPartition some = part(first, std::min(at_a_time, flights() - first));
      auto parts = some.all_gather_flights<Part>([&](std::size_t k) { return make(first + k); }, 0, threads);
      for (Part& each : parts) {
        if (first == 0 && &each == &parts.front())
          sum = std::move(each);
        else
          sum += each;
      }
    }
    return sum;
  }

 private:
  /// @param bytes_of returns the bytes of a flight of this rank
  /// @param take gets the bytes of each flight, in their order: it reads the part of the flight
  void gather(const std::function<std::string(std::size_t)>& bytes_of, std::uint64_t state,
              const std::function<void(std::size_t, internal::Deserializer&)>& take) const;

  Communicator* comm_;
  std::vector<std::size_t> owner_;
};

namespace internal {

/// Partition of the flights of these files, by their sizes on the first rank. An unreadable file is reported
/// by the rank that owns it.
FlightPartition partition_flights(Communicator& comm, const std::vector<std::filesystem::path>& paths);

}  // namespace internal

}  // namespace pcor
