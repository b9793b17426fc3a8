// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/codec.hpp"
#include "common/idl/idl_model.hpp"
#include "common/source_tree.hpp"

#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <iterator>
#include <set>

namespace gridspace::bus {
namespace {

/// The structure that a member is, or is a sequence of.
std::string structure_of(idl::Model const& model, std::size_t type) {
    idl::Type const& found = model.types.at(type);
    bool const several = found.kind == idl::Kind::sequence || found.kind == idl::Kind::array;
    return several ? structure_of(model, found.element) : found.kind == idl::Kind::structure ? found.name : "";
}

// The registry is made by patterns of words; the parser of IDL is the judge.
TEST(CodecRegistry, HasEveryStructureOfTheIdlThatIsNoMemberOfAnother) {
    std::set<std::string> structures, members;
    for (auto const& file : std::filesystem::directory_iterator{source_tree("idl")}) {
        if (file.path().extension() != ".idl") {
            continue;
        }
        std::ifstream in{file.path()};
        auto const model = idl::parse(std::string{std::istreambuf_iterator<char>{in}, {}});
        ASSERT_TRUE(model) << file.path();
        for (idl::Type const& type : model->types) {
            if (type.kind == idl::Kind::structure) {
                structures.insert(type.name);
                for (idl::Type::Member const& member : type.members) {
                    members.insert(structure_of(*model, member.type));
                }
            }
        }
    }
    EXPECT_GE(structures.size(), 20U);
    for (std::string const& name : structures) {
        EXPECT_EQ(find_codec(name) != nullptr, !members.contains(name)) << name;
    }
    EXPECT_EQ(find_codec("SimClocks"), nullptr);
}

} // namespace
} // namespace gridspace::bus
