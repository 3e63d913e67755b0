#include "rt_tests/firmware/image/counted_script.hpp"

#include "rt_tests/firmware/image/semihosting.hpp"

namespace greenloop::firmware {

void PredictedInstructions::print() const {
  firmware::print("units over instructions of ");
  firmware::print(steps_);
  firmware::print(" steps: 0.8..1.25 of ");
  firmware::print(within_);
  firmware::print(", in hundredths least ");
  firmware::print(least_);
  firmware::print(", most ");
  firmware::print(most_);
  firmware::print("\n");
}

}  // namespace greenloop::firmware
