#pragma once

#include <cstdint>
#include <span>

#include "runtime/contact/candidate_search.hpp"
#include "runtime/contact/deformed_surface.hpp"
#include "runtime/contact_body.hpp"
#include "runtime/contact_body/grip.hpp"
#include "runtime/elastostatic.hpp"
#include "runtime/friction/energy.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/surface.hpp"

namespace greenloop {

/// Everything that a contact body keeps in its memory.
struct TouchedBody {
  Elastostatic elastostatic;
  Surface surface;
  DeformedSurface deformed;
  CandidateSearch search;
  std::uint32_t nodes = 0, max_contacts = 0, max_tools = 0;
  double mean_edge = 0;           ///< m
  std::uint64_t least_work = 0;   ///< units of a step
  std::uint64_t search_work = 0;  ///< units that a search for candidates may take
  float rigid_softness = 0;       ///< m/N

  Tool* tool = nullptr;                     ///< [max_tools] of this step
  Placement* placement = nullptr;           ///< [max_tools] the same, after the answer where its spring lets it be
  Placement* last_placement = nullptr;      ///< [max_tools] of the step before, after its answer
  Double3* sag = nullptr;                   ///< [max_tools] m, of the last answer
  std::span<const float> factor;            ///< [nodes] on coefficients of friction, or empty
  std::span<const Vec4> offset;             ///< [nodes] m, that the surface is carried by, or empty
  ToolPoint* point = nullptr;               ///< [max_contacts] of the last answer
  Candidate* candidate = nullptr;           ///< [max_contacts] of this step, by their keys
  UnilateralContact* contact = nullptr;     ///< [max_contacts] the same
  Double3* rest_place = nullptr;            ///< [max_contacts] m, where each stands at rest
  Double3* last_place = nullptr;            ///< [max_contacts] m, where each stood in the last answer
  Vec3* force_before = nullptr;             ///< [max_contacts] N, in it
  EnergyContact* energy_contact = nullptr;  ///< [2 * max_contacts] of this step and the last
  EnergyAccount account;
  ContactBody::Energy energy;
  Double3* stick_place = nullptr;            ///< [max_contacts] m, where each stands if it does not slip
  Vec3* force = nullptr;                     ///< [max_contacts]
  Vec4* gap = nullptr;                       ///< [max_contacts]
  float* yield = nullptr;                    ///< [max_contacts] m
  Vec4* by_loads = nullptr;                  ///< [max_contacts] m, where each would be without contact forces
  float* area = nullptr;                     ///< [nodes] m^2, of the surface at rest
  float* held_out = nullptr;                 ///< [nodes] m, how far the contacts of the last answer push each
  ContactState* state = nullptr;             ///< [max_contacts]
  ContactBody::Contact* answered = nullptr;  ///< [max_contacts] of the last answer
  std::uint32_t answered_count = 0;
  ContactBody::ToolAnswer* tool_answer = nullptr;  ///< [max_tools]
  std::uint32_t tool_count = 0;
  Vec4* displacement = nullptr;  ///< [nodes] m
  Vec4* carried = nullptr;       ///< [nodes] m, offset and displacement; null: it is not carried
  Grips grips;
};

}  // namespace greenloop
