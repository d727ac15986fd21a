!> Hencky's law with its radial return at one Gauss point of each element of a batch.
!>
!> What modules hyperelastic and log_strain compute, in the same operations, with the element as the
!> fastest index. Principal axes are found by rotations of Jacobi that leave an element alone once
!> it has them.
module lopin_batch_law
   use lopin_kinds, only : wp
   use lopin_element_batch, only : lanes
   use lopin_log_strain, only : log_one_plus, exp_minus_one, first_axis, second_axis, series_below
   use lopin_hyperelastic, only : solid_law_type, past_type, answer_of
   use lopin_radial_return, only : return_type
   implicit none
   private
   public :: law_lanes_type, respond_in_lanes, strain_in_lanes, flow_lanes_type, flow_in_lanes

   !> Kirchhoff stress, energy per reference volume, spatial tangent.
   type :: law_lanes_type
      real(wp) :: stress(lanes, 6)         !! [stress]
      real(wp) :: energy(lanes)            !! [stress]
      real(wp) :: tangent(lanes, 6, 6)     !! [stress]
   end type law_lanes_type

   !> Plastic flow of a trial: what modules hyperelastic and material_point keep of it.
   type :: flow_lanes_type
      real(wp) :: step(lanes)              !! of plastic strain
      real(wp) :: stress(lanes)            !! von Mises, at the end [stress]
      real(wp) :: metric(lanes, 6)         !! what is added to the plastic metric
   end type flow_lanes_type

   !> Principal directions and logarithmic strains.
   type :: frame_type
      real(wp) :: axis(lanes, 3, 3)        !! third index: direction
      real(wp) :: change(lanes, 3)         !! b - 1 along each
      real(wp) :: e(lanes, 3)              !! logarithmic strain along each
   end type frame_type

   !> What the return leaves of the trial deviator.
   type :: return_lanes_type
      real(wp), dimension(lanes) :: secant, along, kept, square, step, stress
      real(wp) :: deviator(lanes, 3)
   end type return_lanes_type

contains

   !> Stress and energy and, if asked for, tangent of a deformation.
   pure subroutine respond_in_lanes(law, change, volume, strain, offset, dt, with_tangent, answer)
      type(solid_law_type), intent(in) :: law
      real(wp), intent(in) :: change(lanes, 3, 3)   !! b - 1, of the elastic part of a trial
      real(wp), intent(in) :: volume(lanes)         !! J - 1 that counts
      real(wp), intent(in) :: strain(lanes)         !! plastic strain of the accepted state
      real(wp), intent(in) :: offset(lanes)         !! elastic ln J beyond that of the deformation
      real(wp), intent(in) :: dt                    !! [time]
      logical, intent(in) :: with_tangent
      type(law_lanes_type), intent(inout) :: answer
      type(frame_type) :: frame
      type(return_lanes_type) :: back
      real(wp) :: dilatation(lanes), principal(lanes, 3)
      integer :: k, l

      call find_axes(change, frame)
      do l = 1, lanes
         dilatation(l) = log_one_plus(volume(l)) + offset(l)
      end do
      call return_in_lanes(law, frame, strain, dt, back)
      do k = 1, 3
         principal(:, k) = back%secant*back%deviator(:, k) + law%bulk*dilatation
      end do
      call turn_stress(frame%axis, principal, answer%stress)
      answer%energy = 0.5_wp*law%bulk*dilatation**2 + law%shear*back%kept**2*back%square
      if (with_tangent) call find_tangent(law%bulk, frame, back, principal, answer%tangent)
   end subroutine respond_in_lanes

   !> Logarithmic strain of the deformation scaled to a change of volume; engineering shears.
   pure subroutine strain_in_lanes(change, volume, strain)
      real(wp), intent(in) :: change(lanes, 3, 3)   !! b - 1
      real(wp), intent(in) :: volume(lanes)         !! J - 1
      real(wp), intent(out) :: strain(lanes, 6)
      type(frame_type) :: frame
      real(wp) :: shift(lanes)
      integer :: k, l

      call find_axes(change, frame)
      do l = 1, lanes
         shift(l) = log_one_plus(volume(l))
      end do
      shift = (shift - (frame%e(:, 1) + frame%e(:, 2) + frame%e(:, 3)))/3.0_wp
      do k = 1, 3
         frame%e(:, k) = frame%e(:, k) + shift
      end do
      call turn_stress(frame%axis, frame%e, strain)
      strain(:, 4:) = 2.0_wp*strain(:, 4:)
   end subroutine strain_in_lanes

   !> Plastic flow of a trial deformation.
   pure subroutine flow_in_lanes(law, change, inverse, strain, dt, flow)
      type(solid_law_type), intent(in) :: law
      real(wp), intent(in) :: change(lanes, 3, 3)   !! b - 1, of the elastic part of a trial
      real(wp), intent(in) :: inverse(lanes, 3, 3)  !! of F
      real(wp), intent(in) :: strain(lanes)         !! plastic strain of the accepted state
      real(wp), intent(in) :: dt                    !! [time]
      type(flow_lanes_type), intent(out) :: flow
      type(frame_type) :: frame
      type(return_lanes_type) :: back
      real(wp) :: n(lanes, 3, 3), taken(lanes, 3)
      integer :: i, k, l

      call find_axes(change, frame)
      call return_in_lanes(law, frame, strain, dt, back)
      flow%step = back%step
      flow%stress = back%stress
      flow%metric = 0.0_wp
      if (.not. any(back%step > 0.0_wp)) return
      do k = 1, 3
         do l = 1, lanes
            taken(l, k) = (1.0_wp + frame%change(l, k)) &
               & *exp_minus_one(-2.0_wp*(1.0_wp - back%kept(l))*back%deviator(l, k))
         end do
         do i = 1, 3
            n(:, i, k) = inverse(:, i, 1)*frame%axis(:, 1, k) &
               & + inverse(:, i, 2)*frame%axis(:, 2, k) + inverse(:, i, 3)*frame%axis(:, 3, k)
         end do
      end do
      call turn_stress(n, taken, flow%metric)
   end subroutine flow_in_lanes

   !> The trial deviators and their returns.
   pure subroutine return_in_lanes(law, frame, strain, dt, back)
      type(solid_law_type), intent(in) :: law
      type(frame_type), intent(in) :: frame
      real(wp), intent(in) :: strain(lanes), dt
      type(return_lanes_type), intent(out) :: back
      type(return_type) :: one
      type(past_type) :: past
      real(wp) :: mean(lanes)
      integer :: k, l

      mean = (frame%e(:, 1) + frame%e(:, 2) + frame%e(:, 3))/3.0_wp
      do k = 1, 3
         back%deviator(:, k) = frame%e(:, k) - mean
      end do
      back%square = back%deviator(:, 1)**2 + back%deviator(:, 2)**2 + back%deviator(:, 3)**2
      past%dt = dt
      do l = 1, lanes
         past%strain = strain(l)
         one = answer_of(law, past, sqrt(back%square(l)))
         back%secant(l) = one%secant
         back%along(l) = one%along
         back%kept(l) = one%kept
         back%step(l) = one%step
         back%stress(l) = one%stress
      end do
   end subroutine return_in_lanes

   !> Principal directions of b; directions decoupled from the others stay in place.
   pure subroutine find_axes(change, frame)
      real(wp), intent(in) :: change(lanes, 3, 3)
      type(frame_type), intent(out) :: frame
      real(wp) :: off(lanes, 3)   ! b off the diagonal, by the direction across its plane
      logical :: active(lanes), plane(lanes)
      integer, parameter :: most_sweeps = 20
      integer :: sweep, k, l

      frame%axis = 0.0_wp
      do k = 1, 3
         frame%axis(:, k, k) = 1.0_wp
         frame%change(:, k) = change(:, k, k)
      end do
      off(:, 1) = change(:, 2, 3)
      off(:, 2) = change(:, 1, 3)
      off(:, 3) = change(:, 1, 2)
      plane = .not. abs(off(:, 2)) + abs(off(:, 1)) > 0.0_wp
      active = .true.
      do sweep = 1, most_sweeps
         active = active .and. abs(off(:, 3)) + abs(off(:, 2)) + abs(off(:, 1)) &
            & > 0.01_wp*epsilon(1.0_wp)*(abs(frame%change(:, 1)) + abs(frame%change(:, 2)) &
            & + abs(frame%change(:, 3)))
         if (sweep == 1) active = active .or. plane
         if (sweep == 2) active = active .and. .not. plane
         if (.not. any(active)) exit
         associate (b => frame%change, n => frame%axis)
            call rotate(active, b(:, 1), b(:, 2), off(:, 3), off(:, 2), off(:, 1), n(:, :, 1), &
               & n(:, :, 2))
            call rotate(active, b(:, 1), b(:, 3), off(:, 2), off(:, 3), off(:, 1), n(:, :, 1), &
               & n(:, :, 3))
            call rotate(active, b(:, 2), b(:, 3), off(:, 1), off(:, 3), off(:, 2), n(:, :, 2), &
               & n(:, :, 3))
         end associate
      end do
      do k = 1, 3
         do l = 1, lanes
            frame%e(l, k) = 0.5_wp*log_one_plus(frame%change(l, k))
         end do
      end do
   end subroutine find_axes

   !> One rotation of Jacobi in the plane of two directions p and q, of the elements that want it;
   !> r is across. Loops without branches, columns apart: these are vector instructions.
   pure subroutine rotate(active, change_p, change_q, off_r, off_q, off_p, axis_p, axis_q)
      logical, intent(in) :: active(lanes)
      real(wp), dimension(lanes), intent(inout) :: change_p, change_q, off_r, off_q, off_p
      real(wp), dimension(lanes, 3), intent(inout) :: axis_p, axis_q
      real(wp), dimension(lanes) :: c, s, shear, half, radius, turned
      real(wp) :: t
      integer :: i, l

      shear = merge(off_r, 0.0_wp, active)
      off_r = 0.0_wp
      do l = 1, lanes
         half(l) = 0.5_wp*(change_q(l) - change_p(l))
         radius(l) = sqrt(half(l)**2 + shear(l)**2)
      end do
      ! What is too small to have a square is no shear.
      shear = merge(shear, 0.0_wp, radius > 0.0_wp)
      radius = merge(radius, 1.0_wp, radius > 0.0_wp)
      do l = 1, lanes
         t = shear(l)/(half(l) + sign(radius(l), half(l)))
         c(l) = 1.0_wp/sqrt(1.0_wp + t*t)
         s(l) = t*c(l)
         change_p(l) = change_p(l) - t*shear(l)
         change_q(l) = change_q(l) + t*shear(l)
      end do
      turned = off_q
      off_q = c*turned - s*off_p
      off_p = s*turned + c*off_p
      do i = 1, 3
         turned = axis_p(:, i)
         axis_p(:, i) = c*turned - s*axis_q(:, i)
         axis_q(:, i) = s*turned + c*axis_q(:, i)
      end do
   end subroutine rotate

   !> Tensor of given principal values: xx yy zz xy xz yz.
   pure subroutine turn_stress(n, principal, stress)
      real(wp), intent(in) :: n(lanes, 3, 3), principal(lanes, 3)
      real(wp), intent(out) :: stress(lanes, 6)
      integer :: r

      do r = 1, 6
         stress(:, r) = principal(:, 1)*n(:, first_axis(r), 1)*n(:, second_axis(r), 1) &
            & + principal(:, 2)*n(:, first_axis(r), 2)*n(:, second_axis(r), 2) &
            & + principal(:, 3)*n(:, first_axis(r), 3)*n(:, second_axis(r), 3)
      end do
   end subroutine turn_stress

   !> Spatial tangent from the slopes of the principal stresses and the secants of shear.
   pure subroutine find_tangent(bulk, frame, back, principal, tangent)
      real(wp), intent(in) :: bulk                   !! [stress]
      type(frame_type), intent(in) :: frame
      type(return_lanes_type), intent(in) :: back
      real(wp), intent(in) :: principal(lanes, 3)    !! [stress]
      real(wp), intent(out) :: tangent(lanes, 6, 6)
      real(wp) :: normal(lanes, 3, 3), shear(lanes, 3), d(lanes), below(lanes), square(lanes)
      logical :: near(lanes)
      integer :: i, k

      square = merge(back%square, 1.0_wp, abs(back%along) > 0.0_wp)
      do k = 1, 3
         do i = 1, 3
            normal(:, i, k) = bulk - back%secant/3.0_wp
            if (i == k) normal(:, i, k) = normal(:, i, k) + back%secant
            normal(:, i, k) = normal(:, i, k) &
               & + (back%along*back%deviator(:, k)/square)*back%deviator(:, i)
         end do
      end do
      do k = 1, 3
         normal(:, k, k) = normal(:, k, k) - 2.0_wp*principal(:, k)
         associate (p => first_axis(k + 3), q => second_axis(k + 3))
            d = frame%e(:, p) - frame%e(:, q)
            near = abs(d) < series_below
            below = merge(1.0_wp, frame%change(:, p) - frame%change(:, q), near)
            d = merge(1.0_wp + d**2/3.0_wp - d**4/45.0_wp, &
               & d*(2.0_wp + frame%change(:, p) + frame%change(:, q))/below, near)
            shear(:, k) = 0.5_wp*(back%secant*d - principal(:, p) - principal(:, q))
         end associate
      end do
      call turn_tangent(frame%axis, normal, shear, tangent)
   end subroutine find_tangent

   !> Tangent of principal axes, in x, y and z; see turn_in_space of module log_strain.
   pure subroutine turn_tangent(axis, normal, shear, tangent)
      real(wp), intent(in) :: axis(lanes, 3, 3), normal(lanes, 3, 3), shear(lanes, 3)
      real(wp), intent(out) :: tangent(lanes, 6, 6)
      real(wp), dimension(lanes, 6, 6) :: map, part
      integer :: k, l, r

      do k = 1, 6
         associate (p => first_axis(k), q => second_axis(k))
            do r = 1, 6
               map(:, r, k) = axis(:, first_axis(r), p)*axis(:, second_axis(r), q)
               if (k > 3) map(:, r, k) = map(:, r, k) &
                  & + axis(:, first_axis(r), q)*axis(:, second_axis(r), p)
            end do
         end associate
      end do
      do k = 1, 3
         do r = 1, 6
            part(:, r, k) = normal(:, 1, k)*map(:, r, 1) + normal(:, 2, k)*map(:, r, 2) &
               & + normal(:, 3, k)*map(:, r, 3)
            part(:, r, k + 3) = shear(:, k)*map(:, r, k + 3)
         end do
      end do
      do k = 1, 6
         do r = 1, 6
            do l = 1, lanes
               tangent(l, r, k) = part(l, r, 1)*map(l, k, 1) + part(l, r, 2)*map(l, k, 2) &
                  & + part(l, r, 3)*map(l, k, 3) + part(l, r, 4)*map(l, k, 4) &
                  & + part(l, r, 5)*map(l, k, 5) + part(l, r, 6)*map(l, k, 6)
            end do
         end do
      end do
   end subroutine turn_tangent
end module lopin_batch_law
