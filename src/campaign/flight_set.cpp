#include <pcor/campaign/flight_set.hpp>

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <list>
#include <optional>
#include <set>
#include <utility>

#include <pcor/base/error.hpp>
#include <pcor/base/utc.hpp>
#include "flight/file_state.hpp"
#include "parallel/flight_partition.hpp"
#include "residuals/samples.hpp"
#include "roles/variable_naming.hpp"

namespace pcor {

using namespace internal;

namespace {

constexpr std::size_t max_open = 16;  // files; HDF5 and `BlockCache` keep 9 MB for each

std::size_t bytes_of(const ModelSamples& samples, std::size_t records) {
  return (samples.columns.size() + samples.parameter_dependent.size()) * records +
         samples.along_beam.values.size();
}

std::size_t bytes_of(const FlightSamples& samples) {
  constexpr std::size_t of_motion = 16;  // times, positions, attitude, velocity, flaps
  const std::size_t records = samples.time.size();
  return sizeof(double) *
         (of_motion * records + bytes_of(samples.model, records) + bytes_of(samples.reference, records));
}

std::string title_of(const Flight& flight) {
  std::string text;
  for (const std::string& part : {flight.project(), flight.flight_number()}) {
    if (!part.empty()) text += part + " ";
  }
  return (text.empty() ? flight.path().filename().string() + " " : text) +
         utc_text(flight.time().first, "%Y-%m-%d");
}

}  // namespace

/// Shared state of a set and of sets derived from it. The most recently used samples come first.
struct FlightSet::Memory {
  struct Kept {
    const Entry* flight;
    std::uint64_t key;
    std::shared_ptr<const FlightSamples> samples;
    std::size_t bytes;
  };

  explicit Memory(std::size_t bytes) : free(bytes) {}

  std::size_t free;
  std::list<Kept> kept{};
  std::list<Entry*> open{};  // most recently used first

  bool take(std::size_t bytes) {
    for (auto last = kept.end(); bytes > free && last != kept.begin();) {
      --last;
      if (last->samples.use_count() > 1) continue;
      free += last->bytes;
      last = kept.erase(last);
    }
    if (bytes > free) return false;
    free -= bytes;
    return true;
  }
};

struct FlightSet::Entry {
  std::filesystem::path path{};
  TimestampAlignment timestamp_alignment = TimestampAlignment::begin;
  std::shared_ptr<const FlightSamples> given{};  // samples in memory
  std::shared_ptr<Memory> memory{};
  std::optional<FileState> state{};  // state when first opened
  std::optional<Flight> flight{};
  std::optional<FlightOutline> outline{};

  Entry() = default;
  Entry(const Entry&) = delete;
  Entry& operator=(const Entry&) = delete;

  ~Entry() {
    if (!memory) return;
    memory->open.remove(this);
    memory->kept.remove_if([this](const Memory::Kept& each) {
      if (each.flight != this) return false;
      memory->free += each.bytes;
      return true;
    });
  }

  const Flight& open() {
    if (given)
      throw Error(
          Error::Code::usage,
          fmt::format("{}: these samples are in memory, but the request reads the file; give its path",
                      given->name));
    std::list<Entry*>& others = memory->open;
    if (flight) {
      if (others.front() != this)
        others.splice(others.begin(), others, std::find(others.begin(), others.end(), this));
      return *flight;
    }
    const FileState now(path);
    Flight opened(path, timestamp_alignment);
    if (!state) state = now;
    require_unchanged();
    if (others.size() == max_open) {
      others.back()->flight.reset();
      others.pop_back();
    }
    flight.emplace(std::move(opened));
    others.push_front(this);
    return *flight;
  }

  void require_unchanged() const {
    if (state) state->require(path);
  }
};

FlightSet::FlightSet(std::vector<std::shared_ptr<Entry>> entries, FlightPartition partition,
                     Communicator& comm)
    : entries_(std::move(entries)),
      partition_(std::make_shared<const FlightPartition>(std::move(partition))),
      comm_(&comm) {}

FlightSet::FlightSet()
    : FlightSet(std::vector<std::shared_ptr<Entry>>(), FlightPartition(0), serial_communicator()) {}

FlightSet::FlightSet(const std::vector<std::filesystem::path>& paths, const FlightSetOptions& options)
    : FlightSet({}, partition_flights(*options.comm, paths), *options.comm) {
  const auto memory = std::make_shared<Memory>(options.memory);
  for (const std::filesystem::path& path : paths) {
    auto entry = std::make_shared<Entry>();
    entry->path = path;
    entry->timestamp_alignment = options.timestamp_alignment;
    entry->memory = memory;
    entries_.push_back(std::move(entry));
  }
}

FlightSet::FlightSet(std::initializer_list<std::filesystem::path> paths)
    : FlightSet(std::vector<std::filesystem::path>(paths)) {}

FlightSet::FlightSet(const std::vector<std::shared_ptr<const FlightSamples>>& samples,
                     const FlightSetOptions& options)
    : FlightSet(std::vector<std::filesystem::path>(samples.size()), options) {
  for (std::size_t i = 0; i < samples.size(); ++i) entries_[i]->given = samples[i];
}

FlightSet::FlightSet(std::initializer_list<std::shared_ptr<const FlightSamples>> samples)
    : FlightSet(std::vector<std::shared_ptr<const FlightSamples>>(samples)) {}

std::size_t FlightSet::size() const { return entries_.size(); }

std::string FlightSet::name(std::size_t flight) const {
  const Entry& entry = *entries_[flight];
  return entry.given ? entry.given->name : entry.path.filename().string();
}

const std::filesystem::path& FlightSet::path(std::size_t flight) const { return entries_[flight]->path; }

FlightSet FlightSet::only(std::size_t flight) const {
  return {{entries_[flight]}, FlightPartition(1), serial_communicator()};
}

FlightSet FlightSet::part(std::size_t first, std::size_t count) const {
  const auto begin = entries_.begin() + static_cast<std::ptrdiff_t>(first);
  return {{begin, begin + static_cast<std::ptrdiff_t>(count)}, partition_->part(first, count), *comm_};
}

FlightSet FlightSet::with(const FlightSet& more) const {
  if (more.empty()) return *this;
  std::vector<std::shared_ptr<Entry>> all = entries_;
  all.insert(all.end(), more.entries_.begin(), more.entries_.end());
  return {std::move(all), partition_->with(*more.partition_), *comm_};
}

const Flight& FlightSet::operator[](std::size_t flight) const { return entries_[flight]->open(); }

std::shared_ptr<const FlightSamples> FlightSet::samples(std::size_t flight, const ModelDefinition& model,
                                                        const Reference& reference,
                                                        const MaskOptions& mask) const {
  Entry& entry = *entries_[flight];
  if (entry.given) return entry.given;
  Memory& memory = *entry.memory;
  const std::uint64_t key = samples_key(model, reference, mask);
  const auto known = std::find_if(memory.kept.begin(), memory.kept.end(), [&](const Memory::Kept& each) {
    return each.flight == &entry && each.key == key;
  });
  if (known != memory.kept.end()) {
    memory.kept.splice(memory.kept.begin(), memory.kept, known);
    return known->samples;
  }
  auto read = std::make_shared<const FlightSamples>(read_samples(entry.open(), model, reference, mask));
  const std::size_t bytes = bytes_of(*read);
  if (memory.take(bytes)) memory.kept.push_front({&entry, key, read, bytes});
  return read;
}

std::vector<FlightOutline> FlightSet::outlines() const {
  const bool are_known = std::all_of(entries_.begin(), entries_.end(),
                                     [](const auto& entry) { return entry->outline.has_value(); });
  if (!are_known) {
    const auto found = partition_->all_gather_flights<FlightOutline>([this](std::size_t number) {
      const Entry& entry = *entries_[number];
      if (entry.given) {
        const std::vector<double>& time = entry.given->time;
        return FlightOutline{entry.given->aircraft, "", "", entry.given->name,
                             time.empty() ? 0.0 : time.front()};
      }
      const Flight& file = (*this)[number];
      return FlightOutline{file.aircraft(), naming_of(file).name, file.time_variable(), title_of(file),
                           file.time().first};
    });
    for (std::size_t i = 0; i < size(); ++i) entries_[i]->outline = found[i];
  }
  std::vector<FlightOutline> all;
  for (const auto& entry : entries_) all.push_back(*entry->outline);
  return all;
}

std::vector<std::vector<std::string>> FlightSet::variables() const {
  return partition_->all_gather_flights<std::vector<std::string>>(
      [this](std::size_t number) { return (*this)[number].variables(); });
}

std::string FlightSet::title() const {
  if (empty()) return "no flight";
  const std::string first = outlines().front().title;
  return size() == 1 ? first : fmt::format("{} and {} more", first, size() - 1);
}

void FlightSet::require_one_aircraft() const {
  const std::vector<FlightOutline> known = outlines();
  std::optional<std::size_t> first;  // first flight that states its aircraft
  for (std::size_t i = 0; i < size(); ++i) {
    if (known[i].aircraft.empty()) continue;
    if (!first) first = i;
    if (known[i].aircraft == known[*first].aircraft) continue;
    throw Error(
        Error::Code::usage,
        fmt::format("{} is of the aircraft '{}' and {} of '{}', but a model applies to one aircraft; give "
                    "flights of a single aircraft",
                    name(*first), known[*first].aircraft, name(i), known[i].aircraft));
  }
}

void FlightSet::require_each_once() const {
  std::set<std::pair<dev_t, ino_t>> files;
  for (const auto& entry : entries_) {
    struct stat file {};
    if (entry->given || stat(entry->path.c_str(), &file) != 0 ||
        files.emplace(file.st_dev, file.st_ino).second)
      continue;
    throw Error(Error::Code::usage,
                fmt::format("{} is given twice; give every flight once, to the fit or to --holdout",
                            entry->path.string()));
  }
}

void FlightSet::require_unchanged() const {
  partition_->all_gather_flights<int>([this](std::size_t number) {
    entries_[number]->require_unchanged();
    return 0;
  });
}

}  // namespace pcor
