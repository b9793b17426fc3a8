// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/model_description.hpp"
#include "fmi/status.hpp"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gridspace::fmi {

/// Floats are double; integers and enumerations keep their sign.
using Value = std::variant<double, std::int64_t, std::uint64_t, bool, std::string>;

/// The host of an instance: notified of each call before and after it, and of the FMU's messages.
class Host {
  public:
    virtual ~Host() = default;
    virtual void enter(char const* function) noexcept = 0; ///< "fmi3DoStep"; a text that stays
    virtual void leave() noexcept = 0;
    virtual void say(Status status, std::string_view category, std::string_view message) noexcept = 0;
};

/// A step as far as it came.
struct StepOutcome {
    double reached_s{0};
    bool discarded{false};  ///< not done, or only in part
    bool terminated{false}; ///< the FMU wants to end
};

/// An instance for co-simulation, the same for FMI 2.0 and 3.0. After a failure only the destructor may be called: it
/// says to the FMU what the standard allows then. A failure names FMU, function, and what the FMU has logged.
class Instance {
  public:
    virtual ~Instance() = default;
    Instance(Instance const&) = delete;
    Instance& operator=(Instance const&) = delete;

    /// From Instantiated to the mode in which start values and first inputs are known.
    [[nodiscard]] virtual Result<void> enter_initialization(double start_s, std::optional<double> tolerance) = 0;
    [[nodiscard]] virtual Result<void> exit_initialization() = 0;

    /// `value` holds the alternative of the variable's type; scalars only.
    [[nodiscard]] virtual Result<void> set(Variable const& variable, Value const& value) = 0;
    [[nodiscard]] virtual Result<Value> get(Variable const& variable) = 0;

    /// `may_roll_back`: the state may be set back to before this step. Events are the FMU's own: its event mode
    /// (FMI 3.0) is not used. It may return early where it can make steps of any size.
    [[nodiscard]] virtual Result<StepOutcome> do_step(double from_s, double step_s, bool may_roll_back) = 0;

    /// The present state is kept, in the place of what was kept before; and: becomes the present one again.
    [[nodiscard]] virtual Result<void> keep_state() = 0;
    [[nodiscard]] virtual Result<void> restore_state() = 0;
    /// The present state as octets, and from them. Of an instance of the same FMU.
    [[nodiscard]] virtual Result<std::vector<std::byte>> serialize() = 0;
    [[nodiscard]] virtual Result<void> deserialize(std::vector<std::byte> const& octets) = 0;

  protected:
    Instance() = default;
};

/// Loads the binary of an unpacked FMU and makes its instance. `folder`: where it was unpacked; `binary`: relative to
/// it. `host` must outlive the instance. The code of the FMU runs in this process from here on.
[[nodiscard]] Result<std::unique_ptr<Instance>> instantiate(ModelDescription const& description,
                                                            std::filesystem::path const& folder,
                                                            std::string const& binary, std::string const& name,
                                                            Host& host);

} // namespace gridspace::fmi
