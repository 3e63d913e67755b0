#pragma once

#include "formats/layout.hpp"
#include "formats/view/elastostatic.hpp"
#include "formats/view/file.hpp"
#include "formats/view/impulse_response.hpp"
#include "formats/view/multigrid.hpp"

namespace greenloop {

/// A verified model file, in place: what every file shows, and the view of its problem; a view of any other problem is
/// empty. Code of one problem takes the view of that problem. Pointers into the caller's bytes, which must outlive it
/// and stay unchanged. Trivially copyable; no heap. Made by greenloop::verify only.
struct ModelView : FileView, ElastostaticView {
  ImpulseResponseView impulse_response;
  MultigridView multigrid;
};

}  // namespace greenloop
