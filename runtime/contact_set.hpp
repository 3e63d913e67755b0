#pragma once

#include <bit>
#include <cstdint>
#include <span>

#include "formats/view.hpp"
#include "runtime/elastostatic.hpp"

namespace greenloop {

/// What the loop looks up about a node.
struct NodeFacts {
  std::uint8_t mesh_level = 0;
  bool touchable = false;  ///< a node of every constraint level stands for it
  bool marked = false;     ///< by check_contacts, while it looks for duplicates
};

/// Facts of every node; facts: [node_count]. Start-up; linear in nodes.
void list_node_facts(const ModelView& view, NodeFacts* facts) noexcept;

/// Work units of check_contacts.
constexpr std::uint64_t check_contacts_work(std::uint64_t contacts) { return 4 * contacts; }

/// Refuses contacts that are out of range, not touchable, not finite or named twice; the first at fault decides.
Status check_contacts(std::span<const Contact> contacts, std::uint32_t node_count, NodeFacts* facts) noexcept;

/// Displacements smaller than this count as none, in m: keeps denormal numbers out of the loop.
inline constexpr float least_displacement = 0x1p-80F;
constexpr float without_denormals(float displacement) {
  // no branch on data: the same instructions for every number
  const std::uint32_t tiny = static_cast<std::uint32_t>(displacement < least_displacement) &
                             static_cast<std::uint32_t>(displacement > -least_displacement);
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(displacement) & (tiny - 1));
}

/// The contacts of a step as columns of one constraint level: the places, in the domain, of the nodes that stand for
/// them. Contacts that share a column are merged.
struct ContactSet {
  std::uint32_t level = 0;
  std::uint32_t columns = 0;                 ///< columns that hold them
  std::uint32_t* column = nullptr;           ///< [columns] increasing
  std::uint32_t* place = nullptr;            ///< [contacts] of each contact's column in `column`
  std::uint32_t* members = nullptr;          ///< [columns] contacts merged into it
  std::uint32_t* sorting = nullptr;          ///< [contacts] scratch
  std::uint32_t* place_of_column = nullptr;  ///< [domain] scratch, `layout::none` between calls
};

/// Bound of the work units of resolve_contacts: linear but for a merge sort.
constexpr std::uint64_t resolve_contacts_work(std::uint64_t contacts) {
  std::uint64_t passes = 0;
  while ((std::uint64_t{1} << passes) < contacts) {
    ++passes;
  }
  return (4 + passes) * contacts;
}

/// Resolves checked contacts at `level`, which must have representatives.
void resolve_contacts(std::span<const Contact> contacts, const ModelView& view, const NodeFacts* facts,
                      std::uint32_t level, ContactSet& set) noexcept;

/// Work units of average_displacements and of share_forces.
constexpr std::uint64_t merge_work(std::uint64_t contacts, std::uint64_t columns) { return 6 * (contacts + columns); }

/// displacement[3 * columns]: mean over each column's contacts.
void average_displacements(std::span<const Contact> contacts, const ContactSet& set, float* displacement) noexcept;

/// contact_force[3 * contacts]: each column's force in equal parts, so that the total is kept.
void share_forces(const float* column_force, std::size_t contacts, const ContactSet& set,
                  float* contact_force) noexcept;

}  // namespace greenloop
