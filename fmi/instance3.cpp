// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "fmi/calls.hpp"
#include "fmi/functions3.hpp"
#include "fmi/instances.hpp"

#include <fmt/format.h>

namespace gridspace::fmi {
namespace {

using v3::Reference;

void log_of_fmi3(void* environment, int status, char const* category, char const* message) {
    static_cast<Calls*>(environment)
        ->said(static_cast<Status>(status), category == nullptr ? "" : category, message == nullptr ? "" : message);
}

class Instance3 final : public Instance {
  public:
    Instance3(SharedObject object, v3::Functions const& functions, std::string const& fmu, CoSimulation can, Host& host)
        : object_{std::move(object)}, f_{functions}, can_{std::move(can)}, calls_{fmu, host} {}

    Result<void> create(ModelDescription const& description, std::string const& name, std::string const& resources) {
        Reference const* const no_variables = nullptr;
        v3::IntermediateUpdate* const no_update = nullptr;
        instance_ = calls_.plain("fmi3InstantiateCoSimulation", f_.instantiate, name.c_str(), description.token.c_str(),
                                 resources.c_str(), false, false, false, can_.variable_step, no_variables,
                                 std::size_t{0}, static_cast<void*>(&calls_), &log_of_fmi3, no_update);
        return instance_ != nullptr ? Result<void>{} : calls_.judge(Status::error, "fmi3InstantiateCoSimulation", "");
    }

    ~Instance3() override {
        if (instance_ == nullptr) {
            return;
        }
        if (calls_.fatal()) {
            object_.abandon({instance_, state_});
            return;
        }
        if (state_ != nullptr) {
            calls_.plain("fmi3FreeFMUState", f_.free_state, instance_, &state_);
        }
        if (runs_ && !calls_.failed()) {
            calls_.plain("fmi3Terminate", f_.terminate, instance_);
        }
        calls_.plain("fmi3FreeInstance", f_.free_instance, instance_);
    }

    Result<void> enter_initialization(double start_s, std::optional<double> tolerance) override {
        return calls_.checked("", "fmi3EnterInitializationMode", f_.enter_initialization_mode, instance_,
                              tolerance.has_value(), tolerance.value_or(0), start_s, false, 0.0);
    }
    Result<void> exit_initialization() override {
        runs_ = true;
        return calls_.checked("", "fmi3ExitInitializationMode", f_.exit_initialization_mode, instance_);
    }

    Result<void> set(Variable const& variable, Value const& value) override {
        switch (variable.type) {
        case Type::float32:
            return put(variable, "fmi3SetFloat32", f_.set_float32, static_cast<float>(std::get<double>(value)));
        case Type::float64:
            return put(variable, "fmi3SetFloat64", f_.set_float64, std::get<double>(value));
        case Type::int8:
            return put(variable, "fmi3SetInt8", f_.set_int8, static_cast<std::int8_t>(std::get<std::int64_t>(value)));
        case Type::uint8:
            return put(variable, "fmi3SetUInt8", f_.set_uint8,
                       static_cast<std::uint8_t>(std::get<std::uint64_t>(value)));
        case Type::int16:
            return put(variable, "fmi3SetInt16", f_.set_int16,
                       static_cast<std::int16_t>(std::get<std::int64_t>(value)));
        case Type::uint16:
            return put(variable, "fmi3SetUInt16", f_.set_uint16,
                       static_cast<std::uint16_t>(std::get<std::uint64_t>(value)));
        case Type::int32:
            return put(variable, "fmi3SetInt32", f_.set_int32,
                       static_cast<std::int32_t>(std::get<std::int64_t>(value)));
        case Type::uint32:
            return put(variable, "fmi3SetUInt32", f_.set_uint32,
                       static_cast<std::uint32_t>(std::get<std::uint64_t>(value)));
        case Type::uint64:
            return put(variable, "fmi3SetUInt64", f_.set_uint64, std::get<std::uint64_t>(value));
        case Type::boolean:
            return put(variable, "fmi3SetBoolean", f_.set_boolean, std::get<bool>(value));
        case Type::string:
            return put(variable, "fmi3SetString", f_.set_string, std::get<std::string>(value).c_str());
        default: // enumerations are Int64
            return put(variable, "fmi3SetInt64", f_.set_int64, std::get<std::int64_t>(value));
        }
    }

    Result<Value> get(Variable const& variable) override {
        auto const real = [](auto v) { return Value{static_cast<double>(v)}; };
        auto const whole = [](auto v) { return Value{static_cast<std::int64_t>(v)}; };
        auto const natural = [](auto v) { return Value{static_cast<std::uint64_t>(v)}; };
        switch (variable.type) {
        case Type::float32:
            return fetch(variable, "fmi3GetFloat32", f_.get_float32, real);
        case Type::float64:
            return fetch(variable, "fmi3GetFloat64", f_.get_float64, real);
        case Type::int8:
            return fetch(variable, "fmi3GetInt8", f_.get_int8, whole);
        case Type::uint8:
            return fetch(variable, "fmi3GetUInt8", f_.get_uint8, natural);
        case Type::int16:
            return fetch(variable, "fmi3GetInt16", f_.get_int16, whole);
        case Type::uint16:
            return fetch(variable, "fmi3GetUInt16", f_.get_uint16, natural);
        case Type::int32:
            return fetch(variable, "fmi3GetInt32", f_.get_int32, whole);
        case Type::uint32:
            return fetch(variable, "fmi3GetUInt32", f_.get_uint32, natural);
        case Type::uint64:
            return fetch(variable, "fmi3GetUInt64", f_.get_uint64, natural);
        case Type::boolean:
            return fetch(variable, "fmi3GetBoolean", f_.get_boolean, [](bool v) { return Value{v}; });
        case Type::string:
            return fetch(variable, "fmi3GetString", f_.get_string,
                         [](char const* v) { return Value{std::string{v == nullptr ? "" : v}}; });
        default:
            return fetch(variable, "fmi3GetInt64", f_.get_int64, whole);
        }
    }

    Result<StepOutcome> do_step(double from_s, double step_s, bool may_roll_back) override {
        bool needs_event = false, terminated = false, early = false;
        double reached_s = from_s;
        auto const status =
            static_cast<Status>(calls_.plain("fmi3DoStep", f_.do_step, instance_, from_s, step_s, !may_roll_back,
                                             &needs_event, &terminated, &early, &reached_s));
        if (status == Status::discard) {
            return StepOutcome{.reached_s = reached_s, .discarded = true, .terminated = terminated};
        }
        auto ok = calls_.judge(status, "fmi3DoStep", fmt::format("from {} s", from_s));
        if (!ok) {
            return std::unexpected{ok.error()};
        }
        return StepOutcome{.reached_s = early ? reached_s : from_s + step_s, .terminated = terminated};
    }

    Result<void> keep_state() override {
        return calls_.checked("", "fmi3GetFMUState", f_.get_state, instance_, &state_);
    }
    Result<void> restore_state() override {
        return calls_.checked("", "fmi3SetFMUState", f_.set_state, instance_, state_);
    }
    Result<std::vector<std::byte>> serialize() override {
        std::size_t size = 0;
        auto ok = keep_state();
        ok = ok ? calls_.checked("", "fmi3SerializedFMUStateSize", f_.serialized_size, instance_, state_, &size) : ok;
        std::vector<std::byte> out(ok ? size : 0);
        auto* const octets = reinterpret_cast<std::uint8_t*>(out.data());
        ok = ok ? calls_.checked("", "fmi3SerializeFMUState", f_.serialize, instance_, state_, octets, size) : ok;
        return ok ? Result<std::vector<std::byte>>{std::move(out)} : std::unexpected{ok.error()};
    }
    Result<void> deserialize(std::vector<std::byte> const& octets) override {
        auto const* const data = reinterpret_cast<std::uint8_t const*>(octets.data());
        auto ok =
            calls_.checked("", "fmi3DeserializeFMUState", f_.deserialize, instance_, data, octets.size(), &state_);
        runs_ = runs_ || ok;
        return ok ? restore_state() : ok;
    }

  private:
    template <class T>
    Result<void> put(Variable const& variable, char const* function, v3::Set<T>* setter, T value) {
        Reference const reference = variable.reference;
        return calls_.checked(fmt::format("of '{}'", variable.name), function, setter, instance_, &reference,
                              std::size_t{1}, static_cast<T const*>(&value), std::size_t{1});
    }
    template <class T, class Make>
    Result<Value> fetch(Variable const& variable, char const* function, v3::Get<T>* getter, Make const& make) {
        Reference const reference = variable.reference;
        T value{};
        auto ok = calls_.checked(fmt::format("of '{}'", variable.name), function, getter, instance_, &reference,
                                 std::size_t{1}, &value, std::size_t{1});
        return ok ? Result<Value>{make(value)} : std::unexpected{ok.error()};
    }

    SharedObject object_;
    v3::Functions f_;
    CoSimulation can_;
    Calls calls_;
    v3::Instance instance_{nullptr};
    v3::State state_{nullptr};
    bool runs_{false};
};

} // namespace

Result<std::unique_ptr<Instance>> make_instance3(SharedObject object, ModelDescription const& description,
                                                 std::string const& resources, std::string const& name, Host& host) {
    CoSimulation const can = description.co_simulation.value_or(CoSimulation{});
    v3::Functions const functions = v3::find_functions(object, can);
    if (auto ok = complain_of_missing(object, description); !ok) {
        return std::unexpected{ok.error()};
    }
    auto out = std::make_unique<Instance3>(std::move(object), functions, description.file, can, host);
    auto made = out->create(description, name, resources);
    return made ? Result<std::unique_ptr<Instance>>{std::move(out)} : std::unexpected{made.error()};
}

} // namespace gridspace::fmi
