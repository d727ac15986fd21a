!> How the stresses of the points of an element hang on the displacements of its nodes, by the
!> consistent tangents of the points: Cauchy stress, and the stress of flow where metal flows.
!>
!> A row holds a factor for each component of stress (xx yy zz xy xz yz) and for the stress of flow,
!> at every point; its slope is that of the sum of all products. Stress is the answer to the scaled
!> deformation (module solid_finite_strain): to the deviator of a velocity gradient l and a third of
!> the rate of ln v. With the spatial tangent c, the Kirchhoff stress t changes by
!> l t + t l^T + c : l. The stress of flow of von Mises plasticity is the equivalent Kirchhoff
!> stress; other yield surfaces are asked for differences at the point.
module lopin_point_slopes
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type, element_kind
   use lopin_element_input, only : element_input_type
   use lopin_dilatation, only : dilatation_count
   use lopin_deformation, only : deform
   use lopin_material_memory, only : trial_change, stress_at
   use lopin_material_point, only : point_type, respond_at, keep_at
   use lopin_velocity_form, only : tensor_of
   use lopin_von_mises, only : von_mises_slope
   implicit none
   private
   public :: has_point_slopes, finite_strain_slopes

   !> Way of a difference at a point, in entries of its velocity gradient.
   real(wp), parameter :: step = 1.0e-6_wp

contains

   !> Internal modes and the stretch through a thickness are found by iterations of their own.
   pure logical function has_point_slopes(element)
      type(element_type), intent(in) :: element
      has_point_slopes = element%nmode == 0 .and. element%kind /= element_kind%plane_stress
   end function has_point_slopes

   !> Slopes of rows at finite strain.
   pure subroutine finite_strain_slopes(element, input, flowing, row, slope, bad)
      type(element_type), intent(in) :: element    !! one of has_point_slopes
      type(element_input_type), intent(in) :: input
      logical, intent(in) :: flowing(element%ngauss)   !! since the accepted state
      real(wp), contiguous, intent(in) :: row(:, :, :)   !! (7, ngauss, nrow)
      real(wp), contiguous, intent(out) :: slope(:, :, :)   !! (ndim, nnode, nrow) [stress/length]
      integer, intent(out) :: bad                  !! Gauss point turned inside out, or 0
      type(point_type) :: point(element%ngauss)
      real(wp) :: g(element%ndim, element%nnode, element%ngauss)
      real(wp) :: hoop(element%nnode, element%ngauss)
      real(wp) :: phi(element%ngauss, dilatation_count(element))
      real(wp) :: at_point(7, 3, 3), by_volume(6), q(3, 3), mean, by_amplitude(size(phi, 2))
      integer :: i, k, r

      slope = 0.0_wp
      call deform(element, input, point, g, hoop, phi, bad)
      if (bad > 0) return
      do k = 1, element%ngauss
         if (all(.not. abs(row(:, k, :)) > 0.0_wp)) cycle
         call slopes_of_point(element, input, k, point(k), flowing(k), at_point, by_volume)
         do r = 1, size(row, 3)
            if (all(.not. abs(row(:, k, r)) > 0.0_wp)) cycle
            q = reshape(matmul(row(:, k, r), reshape(at_point, [7, 9])), [3, 3])
            mean = (q(1, 1) + q(2, 2) + q(3, 3))/3.0_wp
            ! By ln v, beside what its third share of the rate gives.
            by_amplitude = 0.0_wp
            if (size(phi, 2) == 0) mean = 0.0_wp
            do i = 1, 3
               q(i, i) = q(i, i) - mean
            end do
            mean = mean + dot_product(row(:6, k, r), by_volume)
            if (size(phi, 2) == 0) then
               do i = 1, 3
                  q(i, i) = q(i, i) + mean
               end do
            else
               by_amplitude = mean/(1.0_wp + point(k)%volume)*phi(k, :)
               call add_amplitudes(element, point, g, hoop, phi, by_amplitude, slope(:, :, r))
            end if
            call add_gradient(g(:, :, k), hoop(:, k), q, slope(:, :, r))
         end do
      end do
   end subroutine finite_strain_slopes

   !> Slopes of Cauchy stress and stress of flow by the entries of a velocity gradient, the volume
   !> ratio that the stress is taken over kept; and by the logarithm of that ratio.
   pure subroutine slopes_of_point(element, input, k, point, flowing, slope, by_volume)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      integer, intent(in) :: k
      type(point_type), intent(in) :: point
      logical, intent(in) :: flowing
      real(wp), intent(out) :: slope(7, 3, 3)
      real(wp), intent(out) :: by_volume(6)
      integer, parameter :: place(3, 3) = reshape([1, 4, 5, 4, 2, 6, 5, 6, 3], [3, 3])
      real(wp), dimension(element%nstress) :: stress
      real(wp) :: tangent(element%nstress, element%nstress), energy, t(3, 3)
      integer :: i, j, m
      logical :: found

      m = element%nstress
      slope = 0.0_wp
      by_volume = 0.0_wp
      call respond_at(input%law, point, input%memory(:, k), input%dt, stress, energy, found, &
         & tangent)
      t = tensor_of(stress)
      do j = 1, 3
         do i = 1, 3
            if (place(i, j) > m) cycle
            slope(:m, i, j) = tangent(:, place(i, j))
            slope(:6, i, j) = slope(:6, i, j) + carried(i, t(j, :))
         end do
      end do
      if (allocated(input%law%plastic)) then
         if (flowing) call flow_by_differences(element, input, k, point, slope(7, :, :))
      else if (flowing) then
         slope(7, :, :) = reshape(matmul(von_mises_slope(six(stress)), &
            & reshape(slope(:6, :, :), [6, 9])), [3, 3])
      end if
      slope(:6, :, :) = slope(:6, :, :)/(1.0_wp + point%volume)
      by_volume = -six(stress)/(1.0_wp + point%volume)
   end subroutine slopes_of_point

   !> l t + t l^T for l of a single entry 1 in row i, with the row of t that it meets.
   pure function carried(i, t) result(change)
      integer, intent(in) :: i
      real(wp), intent(in) :: t(3)
      real(wp) :: change(6)
      real(wp) :: both(3, 3)

      both = 0.0_wp
      both(i, :) = t
      both(:, i) = both(:, i) + t
      change = [both(1, 1), both(2, 2), both(3, 3), both(1, 2), both(1, 3), both(2, 3)]
   end function carried

   pure function six(stress) result(full)
      real(wp), intent(in) :: stress(:)
      real(wp) :: full(6)

      full = 0.0_wp
      full(:size(stress)) = stress
   end function six

   !> The stress of flow of a surface that is not von Mises' or that moves.
   pure subroutine flow_by_differences(element, input, k, point, slope)
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      integer, intent(in) :: k
      type(point_type), intent(in) :: point
      real(wp), intent(inout) :: slope(3, 3)
      real(wp) :: next(size(input%memory, 1)), flow(2), work
      type(point_type) :: moved
      integer :: i, j, side

      do j = 1, 3
         do i = 1, 3
            if (element%ndim == 2 .and. (i == 3 .neqv. j == 3)) cycle
            do side = 1, 2
               moved = point
               moved%h(i, :) = moved%h(i, :) + real(2*side - 3, wp)*step*point%h(j, :)
               moved%h(i, j) = moved%h(i, j) + real(2*side - 3, wp)*step
               call trial_change(moved%h, input%memory(:, k), element%nstress, moved%change)
               next = input%memory(:, k)
               call keep_at(input%law, moved, element%nstress, input%dt, next, work)
               flow(side) = next(stress_at(element%nstress))
            end do
            slope(i, j) = (flow(2) - flow(1))/(2.0_wp*step)
         end do
      end do
   end subroutine flow_by_differences

   !> What a covector on velocity gradients is by the displacements of the nodes.
   pure subroutine add_gradient(g, hoop, q, slope)
      real(wp), contiguous, intent(in) :: g(:, :)      !! (ndim, nnode) [1/length]
      real(wp), contiguous, intent(in) :: hoop(:)      !! (nnode) [1/length]
      real(wp), intent(in) :: q(3, 3)
      real(wp), intent(inout) :: slope(:, :)           !! (ndim, nnode)
      integer :: a, d

      d = size(g, 1)
      do a = 1, size(g, 2)
         slope(:, a) = slope(:, a) + matmul(q(:d, :d), g(:, a))
         if (d == 2) slope(1, a) = slope(1, a) + q(3, 3)*hoop(a)
      end do
   end subroutine add_gradient

   !> The same of a covector on the amplitudes of the volume ratio that counts.
   pure subroutine add_amplitudes(element, point, g, hoop, phi, by_amplitude, slope)
      type(element_type), intent(in) :: element
      type(point_type), intent(in) :: point(:)
      real(wp), contiguous, intent(in) :: g(:, :, :), hoop(:, :), phi(:, :)
      real(wp), intent(in) :: by_amplitude(:)
      real(wp), intent(inout) :: slope(:, :)           !! (ndim, nnode)
      real(wp) :: share, unit(3, 3)
      integer :: i, k

      do k = 1, element%ngauss
         share = dot_product(phi(k, :), by_amplitude)*point(k)%weight*(1.0_wp + point(k)%own)
         unit = 0.0_wp
         do i = 1, 3
            unit(i, i) = share
         end do
         call add_gradient(g(:, :, k), hoop(:, k), unit, slope)
      end do
   end subroutine add_amplitudes
end module lopin_point_slopes
