// Passive loops in C.
#include <cstddef>
#include <new>
#include <type_traits>

#include "runtime/greenloop_contact.h"
#include "runtime/passivity.hpp"

namespace greenloop {
namespace {

static_assert(sizeof(EnergyTank) == sizeof(greenloop_energy_tank));
static_assert(alignof(EnergyTank) == alignof(greenloop_energy_tank));
static_assert(std::is_trivially_copyable_v<EnergyTank> && std::is_standard_layout_v<EnergyTank>);
static_assert(EnergyTank::most_ports == static_cast<int>(GREENLOOP_TANK_PORTS));

EnergyTank& tank_in(greenloop_energy_tank* tank) { return *std::launder(reinterpret_cast<EnergyTank*>(tank)); }

}  // namespace
}  // namespace greenloop

using namespace greenloop;

double greenloop_passive_stiffness(double period, double delay, double damping, double virtual_damping) {
  return passive_stiffness({period, delay, damping}, virtual_damping);
}

double greenloop_coupling_stiffness(double body, double limit) { return coupling_stiffness(body, limit); }

greenloop_energy_tank greenloop_energy_tank_make(double period, double reserve, double most_damping) {
  greenloop_energy_tank tank{};
  tank.enabled = 1;
  tank.period = period;
  tank.reserve = tank.level = reserve;
  tank.most_damping = most_damping;
  return tank;
}

void greenloop_energy_tank_step(greenloop_energy_tank* tank, const double* position, double* force, size_t ports,
                                double stored) {
  tank_in(tank).step({reinterpret_cast<const Double3*>(position), ports}, {reinterpret_cast<Double3*>(force), ports},
                     stored);
}
