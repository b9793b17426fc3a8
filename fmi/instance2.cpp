// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "fmi/calls.hpp"
#include "fmi/functions2.hpp"
#include "fmi/instances.hpp"

#include <array>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>

namespace gridspace::fmi {
namespace {

using v2::Component;
using v2::Reference;

/// fmi2CallbackLogger: printf's format with its arguments.
void log_of_fmi2(void* environment, char const*, int status, char const* category, char const* message, ...) {
    std::array<char, 2048> text{};
    std::va_list arguments;
    va_start(arguments, message);
    (void)std::vsnprintf(text.data(), text.size(), message == nullptr ? " " : message, arguments);
    va_end(arguments);
    static_cast<Calls*>(environment)
        ->said(static_cast<Status>(status), category == nullptr ? "" : category, text.data());
}

class Instance2 final : public Instance {
  public:
    Instance2(SharedObject object, v2::Functions const& functions, std::string const& fmu, CoSimulation can, Host& host)
        : object_{std::move(object)}, f_{functions}, can_{std::move(can)}, calls_{fmu, host},
          callbacks_{log_of_fmi2, std::calloc, std::free, nullptr, &calls_} {}

    Result<void> create(ModelDescription const& description, std::string const& name, std::string const& resources) {
        component_ = calls_.plain("fmi2Instantiate", f_.instantiate, name.c_str(), v2::kCoSimulation,
                                  description.token.c_str(), resources.c_str(), &callbacks_, 0, 0);
        return component_ != nullptr ? Result<void>{} : calls_.judge(Status::error, "fmi2Instantiate", "");
    }

    ~Instance2() override {
        if (component_ == nullptr) {
            return;
        }
        if (calls_.fatal()) {
            object_.abandon({component_, state_});
            return;
        }
        if (state_ != nullptr) {
            calls_.plain("fmi2FreeFMUstate", f_.free_state, component_, &state_);
        }
        if (runs_ && !calls_.failed()) {
            calls_.plain("fmi2Terminate", f_.terminate, component_);
        }
        calls_.plain("fmi2FreeInstance", f_.free_instance, component_);
    }

    Result<void> enter_initialization(double start_s, std::optional<double> tolerance) override {
        auto ok = calls_.checked("", "fmi2SetupExperiment", f_.setup_experiment, component_, tolerance ? 1 : 0,
                                 tolerance.value_or(0), start_s, 0, 0.0);
        return ok ? calls_.checked("", "fmi2EnterInitializationMode", f_.enter_initialization_mode, component_) : ok;
    }
    Result<void> exit_initialization() override {
        runs_ = true;
        return calls_.checked("", "fmi2ExitInitializationMode", f_.exit_initialization_mode, component_);
    }

    Result<void> set(Variable const& variable, Value const& value) override {
        switch (variable.type) {
        case Type::boolean:
            return put(variable, "fmi2SetBoolean", f_.set_boolean, std::get<bool>(value) ? 1 : 0);
        case Type::string:
            return put(variable, "fmi2SetString", f_.set_string, std::get<std::string>(value).c_str());
        case Type::float64:
            return put(variable, "fmi2SetReal", f_.set_real, std::get<double>(value));
        default:
            return put(variable, "fmi2SetInteger", f_.set_integer, static_cast<int>(std::get<std::int64_t>(value)));
        }
    }

    Result<Value> get(Variable const& variable) override {
        switch (variable.type) {
        case Type::boolean:
            return fetch(variable, "fmi2GetBoolean", f_.get_boolean, [](int v) { return Value{v != 0}; });
        case Type::string:
            return fetch(variable, "fmi2GetString", f_.get_string,
                         [](char const* v) { return Value{std::string{v == nullptr ? "" : v}}; });
        case Type::float64:
            return fetch(variable, "fmi2GetReal", f_.get_real, [](double v) { return Value{v}; });
        default:
            return fetch(variable, "fmi2GetInteger", f_.get_integer, [](int v) { return Value{std::int64_t{v}}; });
        }
    }

    Result<StepOutcome> do_step(double from_s, double step_s, bool may_roll_back) override {
        StepOutcome out{.reached_s = from_s + step_s};
        auto const status = static_cast<Status>(
            calls_.plain("fmi2DoStep", f_.do_step, component_, from_s, step_s, may_roll_back ? 0 : 1));
        if (status != Status::discard) {
            auto ok = calls_.judge(status, "fmi2DoStep", fmt::format("from {} s", from_s));
            return ok ? Result<StepOutcome>{out} : std::unexpected{ok.error()};
        }
        out.discarded = true;
        int terminated = 0;
        calls_.plain("fmi2GetBooleanStatus", f_.get_boolean_status, component_, v2::kTerminated, &terminated);
        out.terminated = terminated != 0;
        out.reached_s = from_s;
        calls_.plain("fmi2GetRealStatus", f_.get_real_status, component_, v2::kLastSuccessfulTime, &out.reached_s);
        return out;
    }

    Result<void> keep_state() override {
        return calls_.checked("", "fmi2GetFMUstate", f_.get_state, component_, &state_);
    }
    Result<void> restore_state() override {
        return calls_.checked("", "fmi2SetFMUstate", f_.set_state, component_, state_);
    }
    Result<std::vector<std::byte>> serialize() override {
        std::size_t size = 0;
        auto ok = keep_state();
        ok = ok ? calls_.checked("", "fmi2SerializedFMUstateSize", f_.serialized_size, component_, state_, &size) : ok;
        std::vector<std::byte> out(ok ? size : 0);
        auto* const octets = reinterpret_cast<char*>(out.data());
        ok = ok ? calls_.checked("", "fmi2SerializeFMUstate", f_.serialize, component_, state_, octets, size) : ok;
        return ok ? Result<std::vector<std::byte>>{std::move(out)} : std::unexpected{ok.error()};
    }
    Result<void> deserialize(std::vector<std::byte> const& octets) override {
        auto const* const data = reinterpret_cast<char const*>(octets.data());
        auto ok =
            calls_.checked("", "fmi2DeSerializeFMUstate", f_.deserialize, component_, data, octets.size(), &state_);
        runs_ = runs_ || ok;
        return ok ? restore_state() : ok;
    }

  private:
    template <class T>
    Result<void> put(Variable const& variable, char const* function, v2::Set<T>* setter, T value) {
        Reference const reference = variable.reference;
        return calls_.checked(fmt::format("of '{}'", variable.name), function, setter, component_, &reference,
                              std::size_t{1}, static_cast<T const*>(&value));
    }
    template <class T, class Make>
    Result<Value> fetch(Variable const& variable, char const* function, v2::Get<T>* getter, Make const& make) {
        Reference const reference = variable.reference;
        T value{};
        auto ok = calls_.checked(fmt::format("of '{}'", variable.name), function, getter, component_, &reference,
                                 std::size_t{1}, &value);
        return ok ? Result<Value>{make(value)} : std::unexpected{ok.error()};
    }

    SharedObject object_;
    v2::Functions f_;
    CoSimulation can_;
    Calls calls_;
    v2::CallbackFunctions callbacks_; ///< the FMU keeps the pointer
    Component component_{nullptr};
    v2::State state_{nullptr};
    bool runs_{false};
};

} // namespace

Result<std::unique_ptr<Instance>> make_instance2(SharedObject object, ModelDescription const& description,
                                                 std::string const& resources, std::string const& name, Host& host) {
    CoSimulation const can = description.co_simulation.value_or(CoSimulation{});
    v2::Functions const functions = v2::find_functions(object, can);
    if (auto ok = complain_of_missing(object, description); !ok) {
        return std::unexpected{ok.error()};
    }
    auto out = std::make_unique<Instance2>(std::move(object), functions, description.file, can, host);
    auto made = out->create(description, name, resources);
    return made ? Result<std::unique_ptr<Instance>>{std::move(out)} : std::unexpected{made.error()};
}

} // namespace gridspace::fmi
