#include "runtime/elastostatic/mixed_contacts.hpp"

#include "runtime/algebra/block.hpp"
#include "runtime/algebra/semidefinite.hpp"

namespace greenloop {
namespace {

using Kind = Constraint::Kind;

// of its diagonal entry, that must be left of a row when the others are held: what rounding leaves, and below the
// finest level, where contacts that are apart may become alike, enough that no large forces act against each other
constexpr float independent = 0x1p-18F;
constexpr float apart = 0x1p-5F;

constexpr std::uint64_t block_price = 40;  // multiply-adds that reading and weighing a block is worth

// appends corners to contacts
class Listing {
 public:
  explicit Listing(MixedScratch& scratch) : scratch_(scratch) {}

  void begin(const Constraint& constraint, bool directed) {
    MixedContact contact;
    contact.begin = contact.end = counts_.corners;
    contact.directed = directed;
    for (std::uint32_t r = 0; r < contact.rows(); ++r) {
      contact.value[r] = constraint.value[r];
    }
    counts_.rows += contact.rows();
    scratch_.contact[scratch_.contacts++] = contact;
  }

  void add(std::uint32_t node, const Vec3& part) {
    std::uint32_t& place = scratch_.hold_of_node[node];
    if (place == layout::none) {
      place = counts_.holds;
      scratch_.hold[counts_.holds++] = {node, {}};
    }
    scratch_.corner[counts_.corners++] = {place, part};
    scratch_.contact[scratch_.contacts - 1].end = counts_.corners;
  }

  [[nodiscard]] const MixedCounts& counts() const { return counts_; }

 private:
  MixedScratch& scratch_;
  MixedCounts counts_;
};

bool is_held(const MixedScratch& scratch, const MixedContact& contact, const ContactSet& set) {
  bool held = true;
  for (std::uint32_t k = contact.begin; k < contact.end; ++k) {
    held = held && set.holds(scratch.corner[k].place);
  }
  return held;
}

void add(const Vec3& part, Vec3& sum) {
  sum.x += part.x;
  sum.y += part.y;
  sum.z += part.z;
}

float square_of(const Vec3& part) { return part.x * part.x + part.y * part.y + part.z * part.z; }

// the mean of the members' parts; where they point away from each other it has no direction, and is none
Vec3 mean_part(const MixedContact& joint, const Vec3& sum) {
  const auto members = static_cast<float>(joint.members);
  const bool points = 16 * square_of(sum) > members * joint.square;
  return points ? Vec3{sum.x / members, sum.y / members, sum.z / members} : Vec3{};
}

// takes the contacts to the columns of a set
class Joining {
 public:
  Joining(const MixedSet& all, MixedScratch& scratch) : all_(all), scratch_(scratch) {
    for (std::uint32_t k = 0; k < 2 * all.set.columns; ++k) {
      scratch.of_column[k] = layout::none;
    }
  }

  void join(std::uint32_t i) {
    const MixedContact& contact = scratch_.contact[i];
    scratch_.joint_of[i] = layout::none;
    if (!is_held(scratch_, contact, all_.set)) {
      return;
    }
    const bool single = !all_.finest && contact.end == contact.begin + 1;
    const std::uint32_t first = all_.set.place[scratch_.corner[contact.begin].place];
    std::uint32_t* const alone = scratch_.of_column + std::size_t{2} * first + (contact.directed ? 1 : 0);
    if (single && *alone != layout::none) {
      scratch_.joint_of[i] = *alone;
      merge(contact, scratch_.joint[*alone]);
      return;
    }
    if (single) {
      *alone = joints_;
    }
    scratch_.joint_of[i] = joints_;
    scratch_.joint[joints_++] = on_columns(contact);
  }

  // of the mean of its members each
  void finish() {
    std::uint32_t row = 0;
    for (std::uint32_t j = 0; j < joints_; ++j) {
      MixedContact& joint = scratch_.joint[j];
      const auto members = static_cast<float>(joint.members);
      joint.row = row;
      row += joint.rows();
      for (float& value : joint.value) {
        value /= members;
      }
      for (std::uint32_t k = joint.begin; k < joint.end && joint.members > 1; ++k) {
        Vec3& part = scratch_.column_corner[k].part;
        part = mean_part(joint, part);
      }
    }
    rows_ = row;
  }

  [[nodiscard]] std::uint32_t joints() const { return joints_; }
  [[nodiscard]] std::uint32_t rows() const { return rows_; }

 private:
  void merge(const MixedContact& contact, MixedContact& joint) {
    add(scratch_.corner[contact.begin].part, scratch_.column_corner[joint.begin].part);
    joint.square += square_of(scratch_.corner[contact.begin].part);
    for (std::size_t r = 0; r < 3; ++r) {
      joint.value[r] += contact.value[r];
    }
    ++joint.members;
  }

  MixedContact on_columns(const MixedContact& contact) {
    MixedContact joint = contact;
    joint.begin = corners_;
    joint.square = square_of(scratch_.corner[contact.begin].part);
    for (std::uint32_t k = contact.begin; k < contact.end; ++k) {
      const MixedCorner& corner = scratch_.corner[k];
      scratch_.column_corner[corners_++] = {all_.set.place[corner.place], corner.part};
    }
    joint.end = corners_;
    return joint;
  }

  const MixedSet& all_;
  MixedScratch& scratch_;
  std::uint32_t joints_ = 0, corners_ = 0, rows_ = 0;
};

Float4 load(const Vec3& v) { return Float4{v.x, v.y, v.z, 0.0F}; }

// what amounts at j do at i; where one is directed, its row or column is the sum of all
Block<3> between(const MixedSet& all, const MixedScratch& scratch, const MixedContact& i, const MixedContact& j) {
  Block<3> sum{};
  for (std::uint32_t b = j.begin; b < j.end; ++b) {
    const Float4 part = load(scratch.column_corner[b].part);
    for (std::uint32_t a = i.begin; a < i.end; ++a) {
      float block[9];
      kept_block<3>(all.factor, all.stride, scratch.column_corner[a].place, scratch.column_corner[b].place, block);
      for (std::size_t c = 0; c < 3; ++c) {
        sum.column[c] += splat(part[c]) * (load(scratch.column_corner[a].part) * load_vector<3>(block + 3 * c));
      }
    }
  }
  return sum;
}

// the lower triangle of the projected compliance, row i and column j
void project(const MixedSet& all, std::uint32_t joints, std::uint32_t rows, MixedScratch& scratch) {
  for (std::uint32_t i = 0; i < joints; ++i) {
    const MixedContact& row = scratch.joint[i];
    for (std::uint32_t j = 0; j <= i; ++j) {
      const MixedContact& column = scratch.joint[j];
      const Block<3> block = between(all, scratch, row, column);
      const Float4 total = block.column[0] + block.column[1] + block.column[2];
      for (std::uint32_t c = 0; c < column.rows(); ++c) {
        const Float4 of_column = column.directed ? total : block.column[c];
        float* const to = scratch.matrix + std::size_t{rows} * (column.row + c) + row.row;
        for (std::uint32_t r = 0; r < row.rows(); ++r) {
          to[r] = row.directed ? of_column[0] + of_column[1] + of_column[2] : of_column[r];
        }
      }
    }
  }
}

// what is held, less what is displaced already
void prescribe(const MixedSet& all, std::uint32_t joints, MixedScratch& scratch) {
  for (std::uint32_t j = 0; j < joints; ++j) {
    const MixedContact& joint = scratch.joint[j];
    Float4 sum{};
    for (std::uint32_t k = joint.begin; k < joint.end && all.displaced != nullptr; ++k) {
      const MixedCorner& corner = scratch.column_corner[k];
      sum += load(corner.part) * load_vector<3>(all.displaced + std::size_t{3} * corner.place);
    }
    if (joint.directed) {
      sum[0] += sum[1] + sum[2];
    }
    for (std::uint32_t r = 0; r < joint.rows(); ++r) {
      scratch.amount[joint.row + r] = without_tiny(joint.value[r] - sum[r]);
    }
  }
}

void add_to_columns(std::uint32_t columns, std::uint32_t joints, const MixedScratch& scratch, float* column_force) {
  for (std::uint32_t k = 0; k < 3 * columns; ++k) {
    column_force[k] = 0;
  }
  for (std::uint32_t j = 0; j < joints; ++j) {
    const MixedContact& joint = scratch.joint[j];
    const float* const x = scratch.amount + joint.row;
    for (std::uint32_t k = joint.begin; k < joint.end; ++k) {
      const MixedCorner& corner = scratch.column_corner[k];
      float* const sum = column_force + std::size_t{3} * corner.place;
      sum[0] += corner.part.x * x[0];
      sum[1] += corner.part.y * x[joint.directed ? 0 : 1];
      sum[2] += corner.part.z * x[joint.directed ? 0 : 2];
    }
  }
}

// of each contact, its part of its joint's
void share_amounts(MixedScratch& scratch) {
  for (std::uint32_t i = 0; i < scratch.contacts; ++i) {
    const std::uint32_t j = scratch.joint_of[i];
    for (std::uint32_t r = 0; r < 3; ++r) {
      const bool acts = j != layout::none && r < scratch.joint[j].rows();
      scratch.force[3 * i + r] =
          acts ? scratch.amount[scratch.joint[j].row + r] / static_cast<float>(scratch.joint[j].members) : 0;
    }
  }
}

bool names_same(const Constraint& a, const Constraint& b) { return a.kind == b.kind && a.node == b.node; }

}  // namespace

void MixedScratch::carve(Arena& arena, std::uint32_t most, std::uint32_t nodes, std::uint32_t cycles) noexcept {
  const std::uint64_t rows = std::uint64_t{3} * most;
  hold = arena.take<Constraint>(most);
  hold_of_node = arena.take<std::uint32_t>(nodes);
  hold_force = arena.take<float>(rows);
  corner = arena.take<MixedCorner>(most);
  contact = arena.take<MixedContact>(most);
  column_corner = arena.take<MixedCorner>(most);
  joint = arena.take<MixedContact>(most);
  joint_of = arena.take<std::uint32_t>(most);
  of_column = arena.take<std::uint32_t>(std::uint64_t{2} * most);
  matrix = arena.take<float>(rows * rows);
  diagonal = arena.take<float>(rows);
  amount = arena.take<float>(rows);
  keyed = arena.take<Constraint>(most);
  last_named = arena.take<Constraint>(most);
  waits = arena.take<std::uint32_t>(most);
  force = arena.take<float>(rows);
  glide.carve(arena, most, cycles);
  last.carve(arena, most, most);
  for (std::uint32_t node = 0; hold_of_node != nullptr && node < nodes; ++node) {
    hold_of_node[node] = layout::none;
  }
}

MixedCounts list_mixed(std::span<const Constraint> constraints, const Masks& masks, MixedScratch& scratch) noexcept {
  scratch.contacts = 0;
  Listing list(scratch);
  for (const Constraint& constraint : constraints) {
    if (!is_contact(constraint)) {
      continue;
    }
    list.begin(constraint, constraint.kind == Kind::normal);
    if (constraint.kind == Kind::hold) {
      list.add(constraint.node, {1, 1, 1});
    } else if (constraint.kind == Kind::mask) {
      const Mask& mask = masks.scalar[constraint.node];
      for (std::size_t k = 0; k < mask.node.size(); ++k) {
        list.add(mask.node[k], {mask.weight[k], mask.weight[k], mask.weight[k]});
      }
    } else {
      const DirectedMask& mask = masks.directed[constraint.node];
      for (std::size_t k = 0; k < mask.node.size(); ++k) {
        list.add(mask.node[k], mask.part[k]);
      }
    }
  }
  for (std::uint32_t i = 0; i < list.counts().holds; ++i) {
    scratch.hold_of_node[scratch.hold[i].node] = layout::none;
  }
  return list.counts();
}

std::uint64_t mixed_work(const Prices& prices, std::uint64_t corners, std::uint64_t rows) noexcept {
  return priced(2 * corners, prices.solved_contact) +
         priced(block_price * corners * (corners + 1) / 2, prices.appended) + semidefinite_work(prices, rows) +
         Glide::blend_work(prices, corners);
}

std::uint32_t solve_mixed(const MixedSet& all, MixedScratch& scratch, float* column_force) noexcept {
  Joining joining(all, scratch);
  // what holds all directions first: of rows that depend on each other the later ones have no force
  for (const bool directed : {false, true}) {
    for (std::uint32_t i = 0; i < scratch.contacts; ++i) {
      if (scratch.contact[i].directed == directed) {
        joining.join(i);
      }
    }
  }
  joining.finish();
  const std::uint32_t rows = joining.rows();
  project(all, joining.joints(), rows, scratch);
  prescribe(all, joining.joints(), scratch);
  const std::uint32_t left_out =
      factor_semidefinite(rows, rows, all.finest ? independent : apart, scratch.matrix, scratch.diagonal);
  solve_semidefinite(rows, rows, scratch.matrix, scratch.amount);
  add_to_columns(all.set.columns, joining.joints(), scratch, column_force);
  share_amounts(scratch);
  return left_out;
}

GlideReport glide_mixed(std::span<const Constraint> constraints, const ContactSet& set,
                        MixedScratch& scratch) noexcept {
  bool same = scratch.last.contacts() == scratch.contacts;
  std::uint32_t i = 0;
  for (const Constraint& constraint : constraints) {
    if (!is_contact(constraint)) {
      continue;
    }
    same = same && names_same(constraint, scratch.last_named[i]);
    scratch.last_named[i] = constraint;
    const float* const value = scratch.contact[i].value;
    scratch.keyed[i] = {i, {value[0], value[1], value[2]}};
    scratch.waits[i] = scratch.joint_of[i];
    ++i;
  }
  if (!same) {
    scratch.last.release();
  }
  ContactSet keyed_set = set;
  keyed_set.place = scratch.waits;
  const std::span<const Constraint> keyed(scratch.keyed, scratch.contacts);
  scratch.glide.advance(keyed, keyed_set, scratch.last);
  const GlideReport report = scratch.glide.blend(keyed, scratch.last, nullptr, scratch.force);
  scratch.last.remember(keyed, keyed_set, scratch.force);
  return report;
}

void hand_out_mixed(std::span<const Constraint> constraints, const MixedScratch& scratch, float stiffness,
                    std::span<Vec3> force) noexcept {
  const float* next = scratch.force;
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const float* const known = constraints[i].value;
    if (is_contact(constraints[i])) {
      force[i] = {stiffness * next[0], stiffness * next[1], stiffness * next[2]};
      next += 3;
    } else if (constraints[i].kind == Kind::along) {
      force[i] = {known[0], 0, 0};
    } else {
      force[i] = {known[0], known[1], known[2]};
    }
  }
}

}  // namespace greenloop
