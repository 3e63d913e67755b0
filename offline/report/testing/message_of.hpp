#pragma once

#include <exception>
#include <string>

namespace greenloop::offline {

/// The message of the exception that `action` throws; empty if it throws none.
template <class Action>
std::string message_of(Action&& action) {
  try {
    action();
  } catch (const std::exception& error) {
    return error.what();
  }
  return {};
}

}  // namespace greenloop::offline
