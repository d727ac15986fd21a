!> What the nodes and the internal modes of an enhanced element do at its points.
!>
!> The deformation gradient of a point is F + F0 E(alpha), see module enhanced_modes. A generalised
!> displacement (node or amplitude) has at each point a velocity gradient, listed as in module
!> velocity_form.
module lopin_enhanced_motion
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type
   use lopin_element_input, only : element_input_type
   use lopin_enhanced_modes, only : modes_type, internal_modes, outer_sum, most_modes, most_nodes, &
      & most_points
   use lopin_gradients, only : gradients
   implicit none
   private
   public :: motion_type, move, mode_lanes, list_length, enhanced_change, node_slopes, mode_rows

   real(wp), parameter :: pi = acos(-1.0_wp)

   !> What the nodes do, and the modes.
   type :: motion_type
      type(modes_type) :: modes
      real(wp) :: g(3, most_nodes, most_points)   !! reference slopes [1/length]
      real(wp) :: hoop(most_nodes, most_points)   !! shape function per radius [1/length]
      real(wp) :: weight(most_points)             !! reference volume
      real(wp) :: h(3, 3, most_points)            !! F - 1
      real(wp) :: centre(3, 3)                    !! F0
      real(wp) :: e(most_modes, 3, 3, most_points)   !! F0 times the modes
   end type motion_type

contains

   !> Displacement gradients of the nodes.
   pure subroutine move(element, input, motion, bad)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      type(motion_type), intent(out) :: motion
      integer, intent(out) :: bad
      real(wp) :: determinant, radius
      integer :: d, k, m

      d = element%ndim
      m = element%nnode
      bad = 1
      call internal_modes(element, input%x, motion%modes, determinant)
      if (.not. determinant > 0.0_wp) return
      bad = 0
      motion%h(:, :, :element%ngauss) = 0.0_wp
      motion%hoop(:, :element%ngauss) = 0.0_wp
      do k = 1, element%ngauss
         call gradients(d, m, input%x, element%dn(:, :, k), motion%g(:d, :m, k), determinant)
         motion%weight(k) = element%weight(k)*determinant
         motion%h(:d, :d, k) = outer_sum(d, m, input%u, motion%g(:d, :m, k))
         if (element%axisymmetric) then
            radius = dot_product(input%x(1, :m), element%n(:, k))
            motion%hoop(:m, k) = element%n(:, k)/radius
            motion%h(3, 3, k) = dot_product(input%u(1, :m), motion%hoop(:m, k))
            motion%weight(k) = motion%weight(k)*2.0_wp*pi*radius
         else if (d == 2) then
            motion%weight(k) = motion%weight(k)*input%thickness
         end if
         if (input%scaled) motion%weight(k) = motion%weight(k) &
            & *input%memory(size(input%memory, 1), k)
      end do
      motion%centre = 0.0_wp
      motion%centre(:d, :d) = outer_sum(d, m, input%u, motion%modes%g(:d, :m))
      if (d == 2) motion%centre(3, 3) = dot_product(input%u(1, :m), motion%modes%hoop(:m))
      do k = 1, 3
         motion%centre(k, k) = motion%centre(k, k) + 1.0_wp
      end do
      do k = 1, element%ngauss
         motion%e(element%nmode + 1:mode_lanes(element), :, :, k) = 0.0_wp
         do m = 1, element%nmode
            do d = 1, 3
               motion%e(m, :, d, k) = motion%centre(:, 1)*motion%modes%e(1, d, m, k) &
                  & + motion%centre(:, 2)*motion%modes%e(2, d, m, k) &
                  & + motion%centre(:, 3)*motion%modes%e(3, d, m, k)
            end do
         end do
      end do
   end subroutine move

   !> Modes, and as many zeros that they can be taken by four.
   pure integer function mode_lanes(element)
      type(element_type), intent(in) :: element

      mode_lanes = 4*((element%nmode + 3)/4)
   end function mode_lanes

   !> Entries of a velocity gradient in its list.
   pure integer function list_length(element)
      type(element_type), intent(in) :: element

      list_length = merge(5, 9, element%ndim == 2)
   end function list_length

   !> Enhanced F - 1 of a point.
   pure function enhanced_change(element, motion, k, alpha) result(h)
      type(element_type), intent(in) :: element
      type(motion_type), intent(in) :: motion
      integer, intent(in) :: k
      real(wp), intent(in) :: alpha(:)
      real(wp) :: h(3, 3)
      real(wp) :: e(3, 3)
      integer :: j

      e = gradient_of(element, motion, k, alpha)
      do j = 1, 3
         h(:, j) = motion%h(:, j, k) + (motion%centre(:, 1)*e(1, j) &
            & + motion%centre(:, 2)*e(2, j) + motion%centre(:, 3)*e(3, j))
      end do
   end function enhanced_change

   !> E(alpha) of a point, in the reference shape.
   pure function gradient_of(element, motion, k, alpha) result(e)
      type(element_type), intent(in) :: element
      type(motion_type), intent(in) :: motion
      integer, intent(in) :: k
      real(wp), intent(in) :: alpha(:)
      real(wp) :: e(3, 3)
      integer :: m

      e = 0.0_wp
      do m = 1, element%nmode
         e = e + alpha(m)*motion%modes%e(:, :, m, k)
      end do
   end function gradient_of

   !> Slopes, in the deformed place, of what the displacement of a node does at a point: of its own
   !> shape function, and of the modes, which go with the centre.
   pure subroutine node_slopes(element, motion, k, alpha, inverse, g, hoop)
      type(element_type), intent(in) :: element
      type(motion_type), intent(in) :: motion
      integer, intent(in) :: k
      real(wp), intent(in) :: alpha(:)
      real(wp), intent(in) :: inverse(3, 3)                    !! of the enhanced F
      real(wp), intent(out) :: g(element%ndim, element%nnode)  !! [1/length]
      real(wp), intent(out) :: hoop(element%nnode)             !! [1/length]
      real(wp) :: e(3, 3), slope(3)
      integer :: a, d, j

      d = element%ndim
      e = gradient_of(element, motion, k, alpha)
      hoop = 0.0_wp
      do a = 1, element%nnode
         slope(:d) = motion%g(:d, a, k)
         do j = 1, d
            slope(:d) = slope(:d) + motion%modes%g(j, a)*e(j, :d)
         end do
         do j = 1, d
            g(j, a) = dot_product(slope(:d), inverse(:d, j))
         end do
         if (d == 2) hoop(a) = (motion%hoop(a, k) + e(3, 3)*motion%modes%hoop(a))*inverse(3, 3)
      end do
   end subroutine node_slopes

   !> Velocity gradients of the amplitudes.
   pure subroutine mode_rows(element, motion, k, inverse, l)
      type(element_type), intent(in) :: element
      type(motion_type), intent(in) :: motion
      integer, intent(in) :: k
      real(wp), intent(in) :: inverse(3, 3)              !! of the enhanced F
      real(wp), intent(out) :: l(mode_lanes(element), 9) !! [-]; the first of them, list_length
      integer :: d, i, j, m

      d = element%ndim
      m = mode_lanes(element)
      do j = 1, d
         do i = 1, d
            if (d == 2) then
               l(:, i + 2*j - 2) = motion%e(:m, i, 1, k)*inverse(1, j) &
                  & + motion%e(:m, i, 2, k)*inverse(2, j)
            else
               l(:, i + 3*j - 3) = motion%e(:m, i, 1, k)*inverse(1, j) &
                  & + motion%e(:m, i, 2, k)*inverse(2, j) + motion%e(:m, i, 3, k)*inverse(3, j)
            end if
         end do
      end do
      if (d == 2) l(:, 5) = motion%e(:m, 3, 3, k)*inverse(3, 3)
   end subroutine mode_rows
end module lopin_enhanced_motion
