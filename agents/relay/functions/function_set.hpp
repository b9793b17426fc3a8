// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/functions/function.hpp"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::relay {

/// Logical-node classes of functions (IEC 61850-7-4), in the order in which they are worked on: those that others ask
/// come first.
enum class NodeClass : std::uint8_t { rdir, ptoc, pioc, pdis, ptuv, ptov, ptuf, ptof, pfrc, rsyn, rbrf, rrec };
[[nodiscard]] std::string_view name_of(NodeClass of);
/// Its device number by IEEE C37.2: "51".
[[nodiscard]] std::string_view device_number(NodeClass of);
/// "Z1PDIS1": prefix, class and number (IEC 61850-7-2). Nothing when no class is in the name.
[[nodiscard]] bool class_in(std::string_view name, NodeClass& of);

/// A configured function.
struct NamedFunction {
    std::string name;
    NodeClass of{NodeClass::ptoc};
    bool trips{true}; ///< operating, it trips the relay
    std::unique_ptr<Function> function;
    bool publishes{false}; ///< what it measures, at each sample
};

/// The functions of a relay, worked on in the order of their classes and, within a class, as they stand. Pure; no
/// allocation after construction.
class FunctionSet {
  public:
    /// Functions in the order of order_of().
    explicit FunctionSet(std::vector<NamedFunction> functions)
        : functions_{std::move(functions)}, states_(functions_.size()), blocked_(functions_.size(), true) {}

    /// One instant. `trip`: of the relay, before it.
    void step(Measurement const& measured, bool trip);

    [[nodiscard]] std::vector<NamedFunction> const& functions() const { return functions_; }
    [[nodiscard]] std::vector<FunctionState> const& states() const { return states_; }
    /// What it needs is not measured.
    [[nodiscard]] bool is_blocked(std::size_t function) const { return blocked_[function]; }
    [[nodiscard]] bool picks_up() const { return picks_up_; }
    [[nodiscard]] bool operates() const { return operates_; }
    /// A reclosing closes now: the trip is to be released.
    [[nodiscard]] bool closes() const { return closes_; }

  private:
    std::vector<NamedFunction> functions_;
    std::vector<FunctionState> states_;
    std::vector<bool> blocked_;
    bool picks_up_{false}, operates_{false}, closes_{false};
};

} // namespace gridspace::relay
