!> Feet at the joints of nearly coplanar facets, where the normals of a small-sliding row are held.
!>
!> A node opposite a corner of a chain of chords is as near to one facet as to the next: rounding
!> would choose whose normal it takes, all of them those of one sense, and a ring would wind up in
!> one sense sooner than in the other. There the row has the mean normal of the joint.
module lopin_joint_foot
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_family
   use lopin_facet_basis, only : shape_values, facet_point_of
   use lopin_projection, only : closest_type, place, edge_ends, facet_unit_normal
   use lopin_surface, only : surface_type
   use lopin_smooth_facet, only : feature_cosine
   use lopin_feature, only : projection_type, joint_normal, along_edge
   implicit none
   private
   public :: share_joint

   !> Of a facet: feet as near to a joint are on it (inexact geometry); normals, as cosines, that
   !> differ less are equal.
   real(wp), parameter :: near = 1.0e-3_wp, equal = 1.0_wp - 1.0e-10_wp

contains

   !> Move a foot beside a joint there and give it the normal of the joint.
   pure subroutine share_joint(surface, x, found)
      type(surface_type), intent(in) :: surface
      real(wp), intent(in) :: x(:)             !! (ndim) the point [length]
      type(projection_type), intent(inout) :: found
      type(closest_type) :: joint
      real(wp) :: pseudo(3), own(3), way(3), far
      integer :: family
      logical :: perimeter

      if (found%facet == 0 .or. surface%smooth) return
      if (.not. any(found%place == [place%inside, place%edge, place%vertex])) return
      associate (cell => surface%facets%cell(found%facet), &
         & c => surface%coefficient(:, :, found%facet))
         family = surface%basis%family(cell)
         far = near*surface%size(found%facet)
         way = -found%point
         way(:size(x)) = way(:size(x)) + x
         ! Off a convex joint the direction to the point is its normal.
         if (found%place /= place%inside .and. norm2(way) > far) return
         call nearest_joint(family, surface%basis%ncorner(cell), found%xi, c, far, joint)
         if (joint%place == place%none) return
         call joint_normal(surface, found%facet, joint, pseudo, perimeter)
         own = facet_unit_normal(c, family, joint%xi)
         ! The mean of two that meet smoothly turns by half as much.
         if (perimeter .or. 2.0_wp*dot_product(own, pseudo)**2 - 1.0_wp < feature_cosine) return
         if (dot_product(own, pseudo) > equal) return
         found%xi = joint%xi
         found%point = joint%point
         found%normal = pseudo
         found%shape = shape_values(surface%basis, cell, joint%xi)
         way = -joint%point
         way(:size(x)) = way(:size(x)) + x
         found%gap = dot_product(way, pseudo)
      end associate
   end subroutine share_joint

   !> The vertex, or else the edge, that a place of a facet is at.
   pure subroutine nearest_joint(family, ncorner, xi, c, far, joint)
      integer, intent(in) :: family, ncorner
      real(wp), intent(in) :: xi(2), c(:, :)   !! c: of lopin_facet_basis
      real(wp), intent(in) :: far              !! [length]
      type(closest_type), intent(out) :: joint
      real(wp) :: at(2), here(3), t
      integer :: k

      here = facet_point_of(c, xi)
      do k = 1, ncorner
         at = edge_ends(family, k, 0.0_wp)
         if (family == cell_family%line) at = [real(2*k - 3, wp), 0.0_wp]
         call try_place(place%vertex, k, at, joint)
         if (joint%place /= place%none) return
      end do
      if (family == cell_family%line) return
      do k = 1, ncorner
         t = min(1.0_wp, max(0.0_wp, along_edge(family, k, xi)))
         call try_place(place%edge, k, edge_ends(family, k, t), joint)
         if (joint%place /= place%none) return
      end do

   contains

      pure subroutine try_place(kind, feature, at, joint)
         integer, intent(in) :: kind, feature
         real(wp), intent(in) :: at(2)
         type(closest_type), intent(inout) :: joint

         if (norm2(facet_point_of(c, at) - here) > far) return
         joint%place = kind
         joint%feature = feature
         joint%xi = at
         joint%point = facet_point_of(c, at)
      end subroutine try_place
   end subroutine nearest_joint
end module lopin_joint_foot
