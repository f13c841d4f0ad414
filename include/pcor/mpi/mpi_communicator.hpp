#pragma once

#include <pcor/parallel/communicator.hpp>

namespace pcor {

/// The processes of a run under MPI, those of MPI_COMM_WORLD. It lives between MPI_Init and MPI_Finalize,
/// which are the program's own. What MPI fails with ends the job.
class MpiCommunicator final : public Communicator {
 public:
  MpiCommunicator();

  std::size_t rank() const override { return rank_; }
  std::size_t size() const override { return size_; }

 private:
  std::vector<std::string> exchange(const std::string& own) override;

  std::size_t rank_ = 0;
  std::size_t size_ = 1;
};

}  // namespace pcor
