#pragma once

#include <stdexcept>
#include <vector>

#include "runtime/contact/candidate_search.hpp"
#include "runtime/testing/deformed_body.hpp"

namespace greenloop {

/// A search for candidates in memory of its own, on a body that must outlive it. Throws std::runtime_error if the
/// limits are refused, or a step takes more work than is declared.
class SearchBench {
 public:
  SearchBench(const DeformedBody& body, const CandidateSearch::Limits& limits)
      : body_(&body), memory_(CandidateSearch::required(limits)) {
    const auto created = CandidateSearch::create(limits, {memory_.data(), memory_.size()});
    if (!created) throw std::runtime_error("no search within these limits");
    search = created.search;
  }

  CandidateSearch::Found find(const std::vector<Tool>& tools) {
    std::uint64_t work = 0;
    const auto found = search.find(body_->surface, tools, work);
    if (work > search.find_work(body_->surface, tools)) throw std::runtime_error("more work than declared");
    return found;
  }

  CandidateSearch search;

 private:
  const DeformedBody* body_;
  AlignedBytes memory_;
};

}  // namespace greenloop
