/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file haft.h
 *  All public headers at once. */
#ifndef HAFT_HAFT_H
#define HAFT_HAFT_H

#include "haft/base.h"
#include "haft/beam.h"
#include "haft/chaos.h"
#include "haft/chaos_laws.h"
#include "haft/contact.h"
#include "haft/io.h"
#include "haft/io_case.h"
#include "haft/law.h"
#include "haft/solve.h"
#include "haft/study.h"
#include "haft/study_campaign.h"
#include "haft/study_figures.h"
#include "haft/study_laws.h"
#include "haft/study_report.h"
#include "haft/study_statistics.h"
#include "haft/surface.h"
#include "haft/surface_map.h"

#endif
