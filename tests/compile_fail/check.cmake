# Compiles CASE, which must work with LUMO_RIGHT defined and, without it, fail with a message that matches EXPECT.
# Also given: COMPILER, INCLUDES (separated by |).
string(REPLACE "|" ";-I" includes "-I${INCLUDES}")
set(command ${COMPILER} -std=c++20 -fsyntax-only -Wall -Wextra -Wpedantic -Werror
    -DGLM_FORCE_EXPLICIT_CTOR ${includes} ${CASE})

execute_process(COMMAND ${command} -DLUMO_RIGHT RESULT_VARIABLE result ERROR_VARIABLE errors)
if(NOT result EQUAL 0)
    message(FATAL_ERROR "What is right does not compile:\n${errors}")
endif()
execute_process(COMMAND ${command} RESULT_VARIABLE result ERROR_VARIABLE errors)
if(result EQUAL 0)
    message(FATAL_ERROR "The defect compiles.")
endif()
if(NOT errors MATCHES "${EXPECT}")
    message(FATAL_ERROR "The message does not match '${EXPECT}':\n${errors}")
endif()
