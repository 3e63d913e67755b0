#pragma once

#include <cblas.h>

namespace greenloop::offline {

/// While it lives: threaded OpenBLAS would split its sums by the number of processors; one thread keeps the bits the
/// same everywhere.
class SingleThreadedBlas {
 public:
  SingleThreadedBlas() : before_(openblas_get_num_threads()) { openblas_set_num_threads(1); }
  ~SingleThreadedBlas() { openblas_set_num_threads(before_); }
  SingleThreadedBlas(const SingleThreadedBlas&) = delete;
  SingleThreadedBlas& operator=(const SingleThreadedBlas&) = delete;

 private:
  int before_;
};

}  // namespace greenloop::offline
