"""Sections of true surfaces by planes of constant z.

splines, curves, surfaces  points and derivatives of curves and surfaces, compiled
poles, critical_points     where a parameter has no effect, and where a surface is level
mesh, refinement           a triangle mesh over the faces, fine enough to find every level curve
level_curves, conics       level curves followed on the surfaces; those that are conics
wall_ends                  where walls of constant x and y begin and end
contour_curves, gaps       edges that lie in the plane; rings closed over gaps between faces
section                    all of it: the rings of a section
"""
