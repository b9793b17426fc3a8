// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/fmu/saved_state.hpp"

#include <array>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <string>

namespace gridspace::agents {
namespace {

constexpr std::array<char, 8> kMagic{'G', 'S', 'F', 'M', 'U', '0', '0', '1'};

struct Head {
    std::array<char, 8> magic{kMagic};
    std::int64_t quanta{0};
    std::uint64_t octets{0};
};

} // namespace

Result<void> save(SavedState const& state, std::filesystem::path const& file) {
    std::filesystem::path next = file;
    next += ".new";
    Head const head{.quanta = state.time.quanta, .octets = state.octets.size()};
    std::ofstream out{next, std::ios::binary | std::ios::trunc};
    out.write(reinterpret_cast<char const*>(&head), sizeof head);
    out.write(reinterpret_cast<char const*>(state.octets.data()), static_cast<std::streamsize>(state.octets.size()));
    out.close();
    std::error_code failed;
    std::filesystem::rename(next, file, failed);
    if (!out || failed) {
        return fail(ExitCode::environment, fmt::format("cannot write the state of the FMU to '{}'", file.string()),
                    "is the disk full?");
    }
    return {};
}

Result<std::optional<SavedState>> load_state(std::filesystem::path const& file) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) {
        return std::nullopt;
    }
    std::ifstream in{file, std::ios::binary};
    std::string const text{std::istreambuf_iterator<char>{in}, {}};
    Head head;
    if (text.size() >= sizeof head) {
        std::memcpy(&head, text.data(), sizeof head);
    }
    if (text.size() < sizeof head || head.magic != kMagic || head.octets != text.size() - sizeof head) {
        return fail(ExitCode::environment, fmt::format("'{}' is no state of an FMU, or damaged", file.string()));
    }
    SavedState out{SimTime{head.quanta}, {}};
    out.octets.resize(static_cast<std::size_t>(head.octets));
    std::memcpy(out.octets.data(), text.data() + sizeof head, out.octets.size());
    return out;
}

} // namespace gridspace::agents
