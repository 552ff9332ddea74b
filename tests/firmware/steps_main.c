/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "port.h"

#ifdef STEPS /* a board */

int main(void)
{
    steps_double(STEPS);
    steps_float(STEPS);
    put("end\n");
    return 0;
}

#else /* a host: their number on the command line */

#include <stdlib.h>

int main(int argc, char **argv)
{
    if (argc != 2)
        return 3;
    steps_double((uint32_t)strtoul(argv[1], 0, 10));
    steps_float((uint32_t)strtoul(argv[1], 0, 10));
    return 0;
}

#endif
