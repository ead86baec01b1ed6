// SPDX-License-Identifier: GPL-2.0-or-later
// Lists of argument types.
#pragma once

#include <boost/mpl/at.hpp>
#include <boost/mpl/vector.hpp>

#define TYPELIST_1(...) ::boost::mpl::vector<__VA_ARGS__>
#define TYPELIST_2(...) ::boost::mpl::vector<__VA_ARGS__>
#define TYPELIST_3(...) ::boost::mpl::vector<__VA_ARGS__>
#define TYPELIST_4(...) ::boost::mpl::vector<__VA_ARGS__>
#define TYPELIST_5(...) ::boost::mpl::vector<__VA_ARGS__>
#define TYPELIST_7(...) ::boost::mpl::vector<__VA_ARGS__>
