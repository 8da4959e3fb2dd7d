# cmake -DFILES=a;b;… -DTO=FILE -P SourcesVersion.cmake: a C++ file that defines lumo::reference::sources_version() as 64
# bits of the content of these files.
set(digests)
foreach(file ${FILES})
    file(SHA256 ${file} digest)
    string(APPEND digests ${digest})
endforeach()
string(SHA256 digest "${digests}")
string(SUBSTRING ${digest} 0 16 version)
file(CONFIGURE OUTPUT ${TO} @ONLY CONTENT [[
#include "reference/cache.hpp"

uint64_t lumo::reference::sources_version() { return 0x@version@; }
]])
