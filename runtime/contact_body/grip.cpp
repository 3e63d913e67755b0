#include "runtime/contact_body/grip.hpp"

namespace greenloop {

void Grips::carve(Arena& arena, std::uint32_t contacts) noexcept {
  grip_ = arena.take<Grip>(contacts);
  made_ = arena.take<Grip>(contacts);
}

void Grips::begin_step() noexcept {
  for (std::uint32_t i = 0; i < count_; ++i) grip_[i].stays = false;
}

Grip* Grips::find(std::uint64_t key) noexcept {
  while (next_ < count_ && grip_[next_].key < key) ++next_;
  return next_ < count_ && grip_[next_].key == key ? grip_ + next_ : nullptr;
}

void Grips::turn() noexcept {
  Grip* const last = grip_;
  grip_ = made_;
  made_ = last;
  count_ = made_count_;
  made_count_ = 0;
}

void Grips::forget(std::uint32_t tool) noexcept {
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < count_; ++i) {
    if (tool_of_key(grip_[i].key) != tool) grip_[kept++] = grip_[i];
  }
  count_ = kept;
}

}  // namespace greenloop
