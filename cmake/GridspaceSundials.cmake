# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# The target gridspace_sundials: IDA with its serial vectors and its dense and KLU solvers. Debian's SUNDIALSConfig.cmake asks
# for the compiler's OpenMP, which clang does not have by default and IDA does not need.
find_path(SUNDIALS_INCLUDE_DIR ida/ida.h REQUIRED)
add_library(gridspace_sundials INTERFACE)
target_include_directories(gridspace_sundials SYSTEM INTERFACE "${SUNDIALS_INCLUDE_DIR}")
foreach(part ida nvecserial sunmatrixdense sunmatrixsparse sunlinsoldense sunlinsolklu)
  find_library(SUNDIALS_${part} sundials_${part} REQUIRED)
  target_link_libraries(gridspace_sundials INTERFACE "${SUNDIALS_${part}}")
endforeach()
find_path(KLU_INCLUDE_DIR klu.h PATH_SUFFIXES suitesparse REQUIRED)
target_include_directories(gridspace_sundials SYSTEM INTERFACE "${KLU_INCLUDE_DIR}")
