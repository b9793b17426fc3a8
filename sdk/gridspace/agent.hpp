// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <gridspace/agent.h>
#include <gridspace/description.hpp>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

/// Agents in C++, over the C interface: a class whose members are its settings, topics and signals.
///
///     class Charger final : public gridspace::Agent {
///       public:
///         Charger() : Agent{"charger", "charges an EV as the voltage allows"} {}
///         void begin() override { every(period_s, [this] { decide(); }); }
///       private:
///         gridspace::Setting<gridspace::Fraction> period_s{*this, "period_s", "60", {.above = 0}};
///         gridspace::Reads<BusMeasurement> measurements{*this, "bus_measurements", [this](auto const& m) { ... }};
///         gridspace::Writes<ChargingDecision> decisions{*this, "decisions"};
///     };
///     int main(int argc, char** argv) { return gridspace::run<Charger>(argc, argv); }
///
/// What a function here refuses it throws as a std::runtime_error; an exception that leaves a callback ends the run
/// with exit code 4 and its text. docs/how_to/write_an_agent.md
namespace gridspace {

template <class T>
struct TypeName; ///< the name of a type on the wire; <gridspace/types.h> and `gridspace types FILE` give it

/// The same, for messages too; the struct of a stream has no name on the wire.
template <class T>
[[nodiscard]] constexpr char const* type_name() {
    if constexpr (requires { TypeName<T>::value; }) {
        return TypeName<T>::value;
    } else {
        return "";
    }
}

/// A sequence of a sample, to walk through.
template <class Sequence>
[[nodiscard]] auto items(Sequence const& sequence) {
    return std::span{sequence.items, sequence.length};
}

class Agent {
  public:
    Agent(std::string name, std::string description, std::string role = "member")
        : description_{std::move(name), std::move(description), std::move(role)} {}
    virtual ~Agent() = default;
    Agent(Agent const&) = delete;
    Agent& operator=(Agent const&) = delete;

    /// Once, in the first tick.
    virtual void begin() {}
    /// When the run is over. Nothing can be written any more.
    virtual void end() {}

    /// Simulated time of the sample or timer that it is called for.
    [[nodiscard]] double now_s() const { return gridspace_now_s(handle_); }
    [[nodiscard]] std::int64_t now_ns() const { return gridspace_now_ns(handle_); }
    [[nodiscard]] std::string process() const { return gridspace_process(handle_); } ///< its name in the scenario

    /// Calls `function` at whole multiples of the period, from now on ("60", "1/4"); the timer, for cancel().
    int every(std::string const& period_s, std::function<void()> function) {
        return timer(gridspace_every(handle_, period_s.c_str()), std::move(function));
    }
    /// Calls it once, at a simulated time.
    int at(std::int64_t time_ns, std::function<void()> function) {
        return timer(gridspace_at(handle_, time_ns), std::move(function));
    }
    void cancel(int timer) { gridspace_cancel(handle_, timer); }

    void log(std::string const& text, int level = GRIDSPACE_INFO) const { gridspace_log(level, text.c_str()); }

    // For its members.
    [[nodiscard]] Description& description() { return description_; }
    [[nodiscard]] gridspace_agent* handle() const { return handle_; }
    using Handler = std::function<void(void const* sample, std::size_t size)>;
    void on_begin(std::function<void()> action) { on_begin_.push_back(std::move(action)); }
    void on_sample(std::string const& topic, Handler handler) {
        handlers_[checked(gridspace_reader(handle_, topic.c_str()))] = std::move(handler);
    }
    static int checked(int result) { return result >= 0 ? result : throw std::runtime_error{gridspace_last_error()}; }

    /// The life of the program; its exit code.
    int run(int argc, char** argv) {
        std::string const description = description_.json();
        gridspace_program const program{sizeof program, description.c_str(), nullptr, this, &begins, &comes, &due,
                                        &ends};
        return gridspace_main(&program, argc, argv);
    }

  private:
    int timer(int number, std::function<void()> function) {
        timers_[checked(number)] = std::move(function);
        return number;
    }
    /// No exception passes through the library.
    template <class Body>
    static int guarded(gridspace_agent* handle, Body const& body) {
        try {
            body();
            return 0;
        } catch (std::exception const& e) {
            return gridspace_fail(handle, e.what(), nullptr);
        } catch (...) {
            return gridspace_fail(handle, "an exception that is no std::exception", nullptr);
        }
    }
    static int begins(gridspace_agent* handle, void* self) {
        auto& agent = *static_cast<Agent*>(self);
        agent.handle_ = handle;
        return guarded(handle, [&] {
            for (auto const& action : agent.on_begin_) {
                action();
            }
            agent.begin();
        });
    }
    static int comes(gridspace_agent* handle, int reader, void const* sample, std::size_t size, void* self) {
        return guarded(handle, [&] { static_cast<Agent*>(self)->handlers_.at(reader)(sample, size); });
    }
    static int due(gridspace_agent* handle, int timer, void* self) {
        return guarded(handle, [&] {
            auto const function = static_cast<Agent*>(self)->timers_.at(timer); // it may set another one of this number
            function();
        });
    }
    static void ends(gridspace_agent* handle, void* self) {
        (void)guarded(handle, [&] { static_cast<Agent*>(self)->end(); });
    }

    Description description_;
    gridspace_agent* handle_{nullptr};
    std::vector<std::function<void()>> on_begin_;
    std::map<int, Handler> handlers_;
    std::map<int, std::function<void()>> timers_;
};

/// A number that stays exact, like a period of 1/4800 s.
struct Fraction {
    std::string text;
    double value{0};
};

/// A setting: double, std::int64_t, bool, std::string or Fraction. Without a default it must be given.
template <class T>
class Setting {
  public:
    Setting(Agent& agent, std::string key, SettingOptions const& options = {}) : Setting{agent, key, "", options} {}
    Setting(Agent& agent, std::string key, std::string const& otherwise, SettingOptions const& options) {
        agent.description().setting(key, kind(), otherwise, options);
        agent.on_begin([this, &agent, key] { read(agent.handle(), key); });
    }
    [[nodiscard]] T const& operator*() const { return value_; }
    [[nodiscard]] T const* operator->() const { return &value_; }
    operator T const&() const { return value_; } // NOLINT(google-explicit-constructor): it stands for its value
    operator std::string const&() const          // NOLINT(google-explicit-constructor): a period, for every()
        requires std::is_same_v<T, Fraction>
    {
        return value_.text;
    }

  private:
    static constexpr char const* kind() {
        return std::is_same_v<T, bool>           ? "flag"
               : std::is_same_v<T, std::int64_t> ? "integer"
               : std::is_same_v<T, double>       ? "number"
               : std::is_same_v<T, Fraction>     ? "fraction"
                                                 : "text";
    }
    void read(gridspace_agent* handle, std::string const& key) {
        char const* const text = gridspace_setting(handle, key.c_str());
        if (text == nullptr) {
            return; // it may be left out
        }
        double number = 0;
        if constexpr (std::is_same_v<T, std::string>) {
            value_ = text;
        } else if constexpr (std::is_same_v<T, bool>) {
            value_ = std::string{text} == "true";
        } else if constexpr (std::is_same_v<T, std::int64_t>) {
            value_ = std::stoll(text);
        } else {
            Agent::checked(gridspace_number(handle, key.c_str(), &number));
            if constexpr (std::is_same_v<T, Fraction>) {
                value_ = {text, number};
            } else {
                value_ = number;
            }
        }
    }
    T value_{};
};

/// A topic, or a stream, that the agent reads; `handler` is called with each sample, which is there until it returns.
template <class T>
class Reads {
  public:
    Reads(Agent& agent, std::string topic, std::function<void(T const&)> handler, TopicOptions const& options = {}) {
        agent.description().reads(topic, type_name<T>(), options);
        agent.on_begin([&agent, topic, handler = std::move(handler)] {
            agent.on_sample(topic, [topic, handler](void const* sample, std::size_t size) {
                if (size != sizeof(T)) {
                    throw std::runtime_error{"the struct of '" + topic + "' has " + std::to_string(sizeof(T)) +
                                             " octets, and its samples have " + std::to_string(size) +
                                             ": it is of another IDL, or of another data set"};
                }
                handler(*static_cast<T const*>(sample));
            });
        });
    }
};

/// A topic, or a stream, that the agent writes.
template <class T>
class Writes {
  public:
    Writes(Agent& agent, std::string topic, TopicOptions const& options = {}) : agent_{agent} {
        agent.description().writes(topic, type_name<T>(), options);
        agent.on_begin([this, topic] { number_ = Agent::checked(gridspace_writer(agent_.handle(), topic.c_str())); });
    }
    void write(T const& sample) { Agent::checked(gridspace_write(agent_.handle(), number_, &sample, sizeof sample)); }

  private:
    Agent& agent_;
    int number_{-1};
};

/// A signal of the agent, for recording and display: `signal = value`. Where its name stands for several, like
/// "agent.{process}.{evs}.v_pu": `signal["EV1"] = value`.
class Signal {
  public:
    Signal(Agent& agent, std::string const& name, std::string const& unit = "") : agent_{agent}, declared_{name} {
        agent.description().signal(name, unit);
    }
    Signal& operator=(double value) {
        if (number_ < 0) {
            number_ = Agent::checked(gridspace_declared_signal(agent_.handle(), declared_.c_str(), nullptr));
        }
        Agent::checked(gridspace_signal(agent_.handle(), number_, value));
        return *this;
    }

    /// One of several.
    class One {
      public:
        One(gridspace_agent* handle, int number) : handle_{handle}, number_{number} {}
        One& operator=(double value) {
            Agent::checked(gridspace_signal(handle_, number_, value));
            return *this;
        }

      private:
        gridspace_agent* handle_;
        int number_;
    };
    One operator[](std::string const& value) {
        auto const [known, is_new] = numbers_.try_emplace(value, -1);
        if (known->second < 0) {
            known->second =
                Agent::checked(gridspace_declared_signal(agent_.handle(), declared_.c_str(), value.c_str()));
        }
        return {agent_.handle(), known->second};
    }

  private:
    Agent& agent_;
    std::string declared_;
    int number_{-1};
    std::map<std::string, int> numbers_;
};

/// `int main(int argc, char** argv) { return gridspace::run<MyAgent>(argc, argv); }`
template <class T>
int run(int argc, char** argv) {
    return T{}.run(argc, argv);
}

} // namespace gridspace
