#include <pcor/mpi/mpi_communicator.hpp>

#include <mpi.h>

#include <algorithm>
#include <new>

namespace pcor {
namespace {

/// Bytes that all ranks together exchange in one call: MPI counts them by a 32-bit number.
constexpr std::size_t max_at_once = std::size_t{1} << 30;

}  // namespace

MpiCommunicator::MpiCommunicator() {
  int rank = 0;
  int size = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  rank_ = static_cast<std::size_t>(rank);
  size_ = static_cast<std::size_t>(size);
}

std::vector<std::string> MpiCommunicator::exchange(const std::string& local) {
  const std::uint64_t length = local.size();
  std::vector<std::uint64_t> lengths(size_);
  MPI_Allgather(&length, 1, MPI_UINT64_T, lengths.data(), 1, MPI_UINT64_T, MPI_COMM_WORLD);
  const std::size_t maximum = max_at_once / size_;
  const std::size_t longest = *std::max_element(lengths.begin(), lengths.end());
  // All memory is taken before the messages: a process without memory must not leave the others waiting.
  std::vector<std::string> all;
  std::string bytes;
  int is_exhausted = 0;
  try {
    all.resize(size_);
    std::size_t sum = 0;
    for (std::size_t member = 0; member < size_; ++member) {
      all[member].reserve(lengths[member]);
      sum += std::min<std::size_t>(lengths[member], maximum);
    }
    bytes.resize(sum);
  } catch (const std::bad_alloc&) {
    is_exhausted = 1;
  }
  MPI_Allreduce(MPI_IN_PLACE, &is_exhausted, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  if (is_exhausted != 0) throw std::bad_alloc();
  for (std::size_t first = 0; first < longest; first += maximum) {
    std::vector<int> counts;
    std::vector<int> offsets;
    int end = 0;
    for (const std::uint64_t of_member : lengths) {
      const std::size_t remaining = of_member > first ? of_member - first : 0;
      counts.push_back(static_cast<int>(std::min(remaining, maximum)));
      offsets.push_back(end);
      end += counts.back();
    }
    MPI_Allgatherv(local.data() + std::min(first, local.size()), counts[rank_], MPI_BYTE, bytes.data(),
                   counts.data(), offsets.data(), MPI_BYTE, MPI_COMM_WORLD);
    for (std::size_t member = 0; member < size_; ++member)
      all[member].append(bytes, static_cast<std::size_t>(offsets[member]),
                         static_cast<std::size_t>(counts[member]));
  }
  return all;
}

}  // namespace pcor
