/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The program, apart from all that it is made of: tests link the rest, and run it in processes that they fork. */
#include "command.h"

int main(int argc, char **argv)
{
	return plgen(argc, argv);
}
