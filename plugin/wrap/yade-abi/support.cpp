// SPDX-License-Identifier: GPL-2.0-or-later
#include <lib/factory/Factorable.hpp>

#include <sstream>

namespace yade {

std::vector<PendingClass>& pendingClasses() {
    static std::vector<PendingClass> list;
    return list;
}

std::string nthWord(const char* words, unsigned n) {
    std::istringstream in(words);
    std::string word;
    for (unsigned i = 0; in >> word; ++i)
        if (i == n) return word;
    return "";
}

int countWords(const char* words) {
    std::istringstream in(words);
    std::string word;
    int count = 0;
    while (in >> word) ++count;
    return count;
}

} // namespace yade
