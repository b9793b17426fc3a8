// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/source_tree.hpp"
#include "fmi/archive.hpp"
#include "fmi/instance.hpp"
#include "tests/support/temporary_folder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace gridspace::fmi {

/// Keeps what it is told.
class NotingHost final : public Host {
  public:
    void enter(char const* function) noexcept override {
        ++calls[function];
        ++depth;
    }
    void leave() noexcept override { --depth; }
    void say(Status status, std::string_view, std::string_view message) noexcept override {
        said.push_back(fmt::format("{}: {}", name_of(status), message));
    }
    std::map<std::string, int> calls;
    std::vector<std::string> said;
    int depth{0};
};

/// An FMU from its file to its instance.
struct FmuUnderTest {
    explicit FmuUnderTest(std::filesystem::path const& file) {
        auto archive = Archive::open(file);
        EXPECT_TRUE(archive) << archive.error().message;
        auto read = read_model_description(*archive, file.filename().string());
        EXPECT_TRUE(read) << read.error().message;
        description = *read;
        auto const binary = binary_of(*archive, description);
        EXPECT_TRUE(binary) << binary.error().message;
        EXPECT_TRUE(archive->unpack(folder.path()));
        auto made = instantiate(description, folder.path(), *binary, "sut", host);
        if (!made) {
            throw std::runtime_error{describe(made.error())};
        }
        instance = std::move(*made);
    }
    void set(std::string const& name, Value const& value) {
        auto const ok = instance->set(*description.find(name), value);
        EXPECT_TRUE(ok) << ok.error().message;
    }
    Value get(std::string const& name) {
        auto const value = instance->get(*description.find(name));
        EXPECT_TRUE(value) << value.error().message;
        return value.value_or(Value{});
    }
    double number(std::string const& name) { return std::get<double>(get(name)); }
    void begin(double start_s = 0) {
        EXPECT_TRUE(instance->enter_initialization(start_s, std::nullopt));
        EXPECT_TRUE(instance->exit_initialization());
    }
    [[nodiscard]] CoSimulation can() const { return description.co_simulation.value_or(CoSimulation{}); }

    TemporaryFolder folder;
    NotingHost host;
    ModelDescription description;
    std::unique_ptr<Instance> instance; // before what it was loaded from
};

/// Of the tests' own FMUs: "lag" or "misfit", by version.
inline std::filesystem::path own_fmu(std::string const& model, int version) {
    return build_tree(fmt::format("tests/fmus/{}_fmi{}.fmu", model, version));
}

} // namespace gridspace::fmi
