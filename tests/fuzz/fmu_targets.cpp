// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "fmi/archive.hpp"
#include "fmi/model_description.hpp"
#include "targets.hpp"

#include <span>
#include <string>

namespace gridspace::fuzz {

void fmu(std::uint8_t const* data, std::size_t size) {
    constexpr std::uint64_t kEnough = 65536; // of a file that is read
    std::string const text(reinterpret_cast<char const*>(data), size);
    auto const archive = fmi::Archive::open(std::as_bytes(std::span{text}), "fuzz.fmu");
    if (archive) {
        for (fmi::Archive::Entry const& entry : archive->entries()) {
            auto const content = archive->read(entry.name, kEnough);
            require(!content || content->size() == entry.octets, "a file is not as long as the table says");
        }
        if (auto const description = fmi::read_model_description(*archive, "fuzz.fmu")) {
            (void)fmi::binary_of(*archive, *description);
        }
    }
    if (auto const description = fmi::parse_model_description(text, "fuzz.fmu")) {
        for (fmi::Variable const& variable : description->variables) {
            require(description->find(variable.name) != nullptr, "a variable is not found by its name");
        }
    }
}

} // namespace gridspace::fuzz
