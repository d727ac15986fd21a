!> Pressure that follows the face it presses on: forces in the present place, and their slopes.
!>
!> The force of a point is -p times the area vector n dA, which is the product of the tangents
!> (Schweizerhof and Ramm 1984), so forces and slopes are polynomials of the coordinates. The slopes
!> are not symmetric, except for a closed surface under one pressure.
module lopin_follower_face
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   use lopin_element_type, only : element_type, element_kind
   use lopin_facets, only : facet_rule_type
   implicit none
   private
   public :: follower_force

   real(wp), parameter :: pi = acos(-1.0_wp)

contains

   !> Nodal forces of a pressure on one face, and d(-force)/dx if asked for. In plane stress the
   !> thickness is that of the section: its change under load is left out.
   pure subroutine follower_force(element, rules, face, x, thickness, pressure, force, slope)
      type(element_type), intent(in) :: element
      type(facet_rule_type), intent(in) :: rules(:)   !! of new_facet_rules
      integer, intent(in) :: face                     !! Abaqus face number
      real(wp), intent(in) :: x(:, :)                 !! (ndim, m) nodes of the face, where they are
                                                      !! now [length]
      real(wp), intent(in) :: thickness               !! plane kinds [length]
      real(wp), intent(in) :: pressure                !! > 0 pushes into the element [stress]
      real(wp), intent(out) :: force(:, :)            !! (ndim, m) [force]
      real(wp), intent(out), optional :: slope(:, :, :, :)   !! (ndim, m, ndim, m) [force/length]
      real(wp) :: scale
      integer :: k

      force = 0.0_wp
      if (present(slope)) slope = 0.0_wp
      scale = pressure
      if (element%kind <= element_kind%plane_stress) scale = scale*thickness
      if (element%axisymmetric) scale = scale*2.0_wp*pi
      associate (rule => rules(element%cell%face_cell(face)))
         do k = 1, rule%npoint
            if (element%ndim == 3) then
               call add_in_space(rule, k, x, scale*rule%weight(k), force, slope)
            else
               call add_in_plane(rule, k, x, element%axisymmetric, scale*rule%weight(k), force, &
                  & slope)
            end if
         end do
      end associate
   end subroutine follower_force

   pure subroutine add_in_space(rule, k, x, scale, force, slope)
      type(facet_rule_type), intent(in) :: rule
      integer, intent(in) :: k
      real(wp), intent(in) :: x(:, :), scale
      real(wp), intent(inout) :: force(:, :)
      real(wp), intent(inout), optional :: slope(:, :, :, :)
      real(wp) :: t1(3), t2(3), normal(3), unit(3), turn(3)
      integer :: a, b, i

      t1 = matmul(x, rule%dn(1, :, k))
      t2 = matmul(x, rule%dn(2, :, k))
      normal = scale*cross(t1, t2)
      do a = 1, size(x, 2)
         force(:, a) = force(:, a) - rule%n(a, k)*normal
      end do
      if (.not. present(slope)) return
      do b = 1, size(x, 2)
         do i = 1, 3
            unit = 0.0_wp
            unit(i) = scale
            turn = rule%dn(1, b, k)*cross(unit, t2) + rule%dn(2, b, k)*cross(t1, unit)
            do a = 1, size(x, 2)
               slope(:, a, i, b) = slope(:, a, i, b) + rule%n(a, k)*turn
            end do
         end do
      end do
   end subroutine add_in_space

   !> The outward side is to the right of the way along the face; rings have the factor r.
   pure subroutine add_in_plane(rule, k, x, ring, scale, force, slope)
      type(facet_rule_type), intent(in) :: rule
      integer, intent(in) :: k
      real(wp), intent(in) :: x(:, :), scale
      logical, intent(in) :: ring
      real(wp), intent(inout) :: force(:, :)
      real(wp), intent(inout), optional :: slope(:, :, :, :)
      real(wp) :: t(2), normal(2), radius, push
      integer :: a, b

      t = matmul(x, rule%dn(1, :, k))
      normal = scale*[t(2), -t(1)]
      radius = 1.0_wp
      if (ring) radius = dot_product(x(1, :), rule%n(:, k))
      do a = 1, size(x, 2)
         force(:, a) = force(:, a) - rule%n(a, k)*radius*normal
      end do
      if (.not. present(slope)) return
      do b = 1, size(x, 2)
         push = scale*radius*rule%dn(1, b, k)
         do a = 1, size(x, 2)
            slope(2, a, 1, b) = slope(2, a, 1, b) - rule%n(a, k)*push
            slope(1, a, 2, b) = slope(1, a, 2, b) + rule%n(a, k)*push
            if (ring) slope(:, a, 1, b) = slope(:, a, 1, b) &
               & + rule%n(a, k)*rule%n(b, k)*normal
         end do
      end do
   end subroutine add_in_plane
end module lopin_follower_face
