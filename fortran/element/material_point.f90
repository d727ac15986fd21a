!> What a material answers at an integration point: the one place where elements ask, at finite and
!> at small strain, for the answer and for the memory of the next accepted state.
!>
!> Von Mises plasticity with a surface that only grows has its radial return in principal axes; any
!> other yield surface, or one that moves, goes by module plastic_return. Plane stress is found here
!> for all of them: the strain through the thickness at which the stress across it vanishes.
module lopin_material_point
   use lopin_kinds, only : wp
   use lopin_vectors, only : inverse_of
   use lopin_kelvin, only : root_two, unit_kelvin, kelvin_rotation
   use lopin_log_strain, only : log_frame_type, mapped_tensor, log_one_plus, exp_minus_one
   use lopin_hyperelastic, only : solid_law_type, finite_response, past_type, flow_of_trial, &
      & answer_of, thickness_change, condense_thickness
   use lopin_flow_curve, only : flow_at
   use lopin_radial_return, only : return_type
   use lopin_plastic_return, only : plastic_answer_type, return_to_surface
   use lopin_material_frame, only : material_frame_type, new_material_frame, &
      & frame_elastic_strain, spatial_stress, spatial_tangent, plastic_map
   use lopin_material_memory, only : past_of, &
      & plastic_past_of, put_plastic, put_return, map_of, put_map
   implicit none
   private
   public :: point_type, respond_at, keep_at, stretch_thickness
   public :: small_answer_type, respond_small, keep_small

   !> Where the deformation has brought an integration point.
   type :: point_type
      real(wp) :: h(3, 3)          !! F - 1
      real(wp) :: change(3, 3)     !! b - 1, of the elastic part if no point flowed
      real(wp) :: own              !! J - 1
      real(wp) :: volume           !! J - 1 that counts: own, or projected
      real(wp) :: weight           !! reference volume
   end type point_type

   !> Answer at small strain.
   type :: small_answer_type
      real(wp) :: stress(6) = 0.0_wp       !! [stress]
      real(wp) :: tangent(6, 6) = 0.0_wp   !! by engineering shears, symmetric [stress]
      real(wp) :: across = 0.0_wp          !! plane stress: elastic trial strain zz
      real(wp) :: trace = 0.0_wp           !! of the elastic strain
      real(wp) :: distortion = 0.0_wp      !! sqrt(e:e) of its deviator e
      logical :: found = .true.            !! the return has converged
   end type small_answer_type

contains

   !> Kirchhoff stress, energy per reference volume and, if asked for, spatial tangent.
   pure subroutine respond_at(law, point, memory, dt, stress, energy, found, tangent)
      type(solid_law_type), intent(in) :: law
      type(point_type), intent(in) :: point
      real(wp), contiguous, intent(in) :: memory(:)    !! of the accepted state; empty: none
      real(wp), intent(in) :: dt                       !! since the accepted state [time]
      real(wp), contiguous, intent(out) :: stress(:)   !! (4 or 6) [stress]
      real(wp), intent(out) :: energy                  !! elastic [stress]
      logical, intent(out) :: found                    !! the return has converged
      real(wp), contiguous, intent(out), optional :: tangent(:, :)   !! [stress]

      found = .true.
      if (allocated(law%plastic)) then
         call respond_plastic(law, point, memory, dt, stress, energy, found, tangent)
      else
         call finite_response(law, past_of(memory, size(stress), dt), point%change, point%own, &
            & point%volume, stress, energy, tangent)
      end if
   end subroutine respond_at

   pure subroutine respond_plastic(law, point, memory, dt, stress, energy, found, tangent)
      type(solid_law_type), intent(in) :: law
      type(point_type), intent(in) :: point
      real(wp), contiguous, intent(in) :: memory(:)
      real(wp), intent(in) :: dt
      real(wp), contiguous, intent(out) :: stress(:)
      real(wp), intent(out) :: energy
      logical, intent(out) :: found
      real(wp), contiguous, intent(out), optional :: tangent(:, :)
      type(material_frame_type) :: frame
      type(plastic_answer_type) :: answer
      type(past_type) :: past
      real(wp) :: total(6), all(6, 6), dilatation
      integer :: m, k

      m = size(stress)
      call plastic_answer(law, point, memory, dt, m, frame, answer)
      found = answer%found
      past = past_of(memory, m, dt)
      dilatation = log_one_plus(point%volume) + past%offset
      total = answer%stress + law%bulk*dilatation*unit_kelvin
      all(:, 1) = spatial_stress(frame, total)
      stress = all(:m, 1)
      energy = 0.5_wp*law%bulk*dilatation**2 &
         & + dot_product(answer%stress, answer%stress)/(4.0_wp*law%shear)
      if (.not. present(tangent)) return
      ! Recovery of the backstress makes the slope a little unsymmetric; matrices are symmetric.
      answer%slope = 0.5_wp*(answer%slope + transpose(answer%slope))
      do k = 1, 3
         answer%slope(:3, k) = answer%slope(:3, k) + law%bulk
      end do
      all = spatial_tangent(frame, total, answer%slope)
      tangent = all(:m, :m)
   end subroutine respond_plastic

   !> The return of a trial deformation.
   pure subroutine plastic_answer(law, point, memory, dt, nstress, frame, answer)
      type(solid_law_type), intent(in) :: law
      type(point_type), intent(in) :: point
      real(wp), contiguous, intent(in) :: memory(:)
      real(wp), intent(in) :: dt
      integer, intent(in) :: nstress
      type(material_frame_type), intent(out) :: frame
      type(plastic_answer_type), intent(out) :: answer
      type(past_type) :: past

      past = past_of(memory, nstress, dt)
      call new_material_frame(frame, point%h, map_of(memory, nstress), law%plastic%axes)
      call return_to_surface(law%plastic, flow_at(law%flow, past%temperature), law%shear, &
         & frame_elastic_strain(frame), &
         & plastic_past_of(memory, nstress, law%plastic%kinematic%n, dt), answer)
   end subroutine plastic_answer

   !> The memory of a point for the state that is accepted, and the plastic work since the last.
   !>
   !> The metric changes by F**-1 (b after flow - b of the trial) F**-T, written in the principal
   !> directions of the trial. The work is that of the mean of the stresses before and after.
   pure subroutine keep_at(law, point, nstress, dt, memory, work)
      type(solid_law_type), intent(in) :: law
      type(point_type), intent(in) :: point
      integer, intent(in) :: nstress
      real(wp), intent(in) :: dt
      real(wp), contiguous, intent(inout) :: memory(:)
      real(wp), intent(out) :: work                    !! per reference volume [stress]
      type(return_type) :: back
      type(material_frame_type) :: frame
      type(plastic_answer_type) :: answer
      type(log_frame_type) :: trial
      real(wp) :: taken(3)

      work = 0.0_wp
      if (allocated(law%plastic)) then
         call plastic_answer(law, point, memory, dt, nstress, frame, answer)
         if (.not. answer%step > 0.0_wp) return
         work = answer%work
         call put_map(memory, nstress, plastic_map(frame, map_of(memory, nstress), answer%flow, &
            & law%plastic%axes))
         call put_plastic(memory, nstress, law%plastic%kinematic%n, answer)
         return
      end if
      call flow_of_trial(law, past_of(memory, nstress, dt), point%change, back, trial, taken)
      if (.not. back%step > 0.0_wp) return
      memory(:nstress) = memory(:nstress) &
         & + mapped_tensor(trial, taken, inverse_of(point%h), nstress)
      call put_return(memory, nstress, back%step, back%stress, work)
   end subroutine keep_at

   !> Plane stress: the stretch through the thickness at which there is no stress across it.
   pure subroutine stretch_thickness(law, memory, nstress, dt, point, found)
      type(solid_law_type), intent(in) :: law
      real(wp), contiguous, intent(in) :: memory(:)
      integer, intent(in) :: nstress
      real(wp), intent(in) :: dt
      type(point_type), intent(inout) :: point         !! in: no stretch through the thickness
      logical, intent(out) :: found
      type(past_type) :: past
      real(wp) :: h, metric, area

      found = .true.
      past = past_of(memory, nstress, dt)
      metric = 0.0_wp
      if (size(memory) > 0) metric = memory(3)
      area = point%own
      h = thickness_change(law, past, metric, point%change, area)
      call set_thickness(point, h, metric, area)
      if (law%flows) call balance_thickness(law, memory, nstress, dt, metric, area, point, found)
   end subroutine stretch_thickness

   pure subroutine set_thickness(point, h, metric, area)
      type(point_type), intent(inout) :: point
      real(wp), intent(in) :: h
      real(wp), intent(in) :: metric                   !! plastic metric zz
      real(wp), intent(in) :: area                     !! stretch of the area in the plane - 1

      point%change(3, 3) = h*(2.0_wp + h) + metric*(1.0_wp + h)**2
      point%own = area + h*(1.0_wp + area)
      point%volume = point%own
      point%h(3, 3) = h
   end subroutine set_thickness

   !> Newton in the logarithm of the stretch, inside a bracket: the stress rises with it.
   pure subroutine balance_thickness(law, memory, nstress, dt, metric, area, point, found)
      type(solid_law_type), intent(in) :: law
      real(wp), contiguous, intent(in) :: memory(:)
      integer, intent(in) :: nstress
      real(wp), intent(in) :: dt, metric, area
      type(point_type), intent(inout) :: point
      logical, intent(out) :: found
      integer, parameter :: most = 100
      real(wp) :: stress(4), tangent(4, 4), energy, z, low, high, next, scale
      integer :: i

      z = log_one_plus(point%h(3, 3))
      scale = maxval(abs(point%change)) + abs(metric)
      low = -huge(low)
      high = huge(high)
      do i = 1, most
         call set_thickness(point, exp_minus_one(z), metric, area)
         call respond_at(law, point, memory, dt, stress(:nstress), energy, found, tangent)
         if (.not. found) return
         if (stress(3) < 0.0_wp) low = z
         if (stress(3) >= 0.0_wp) high = z
         next = z - stress(3)/(tangent(3, 3) + 2.0_wp*stress(3))
         if (.not. tangent(3, 3) + 2.0_wp*stress(3) > 0.0_wp) next = z - sign(scale, stress(3))
         if (abs(next - z) <= 4.0_wp*epsilon(z)*max(scale, abs(z))) return
         if (.not. next > low) next = 0.5_wp*(low + z)
         if (.not. next < high) next = 0.5_wp*(z + high)
         if (.not. (next > low .and. next < high)) return
         z = next
      end do
      found = .false.
   end subroutine balance_thickness

   !> Small strain: stress, tangent and elastic strain of an elastic trial strain.
   pure subroutine respond_small(law, plane, memory, dt, strain, answer)
      type(solid_law_type), intent(in) :: law
      logical, intent(in) :: plane                     !! plane stress: zz of the strain is not read
      real(wp), contiguous, intent(in) :: memory(:)    !! of the accepted state; empty: none
      real(wp), intent(in) :: dt                       !! since the accepted state [time]
      real(wp), contiguous, intent(in) :: strain(:)    !! (4 or 6) engineering shears
      type(small_answer_type), intent(out) :: answer
      integer, parameter :: most = 100
      real(wp) :: full(6), low, high, next, scale
      integer :: i, m

      m = size(strain)
      full = 0.0_wp
      full(:m) = strain
      if (plane) then
         full(3) = -(3.0_wp*law%bulk - 2.0_wp*law%shear)/(3.0_wp*law%bulk + 4.0_wp*law%shear) &
            & *(full(1) + full(2))
         scale = maxval(abs(full))
         low = -huge(low)
         high = huge(high)
         do i = 1, most
            call respond_in_full(law, memory, m, dt, full, answer)
            if (.not. answer%found) return
            if (answer%stress(3) < 0.0_wp) low = full(3)
            if (answer%stress(3) >= 0.0_wp) high = full(3)
            next = full(3) - answer%stress(3)/answer%tangent(3, 3)
            if (abs(next - full(3)) <= 4.0_wp*epsilon(scale)*max(scale, abs(next))) exit
            if (.not. next > low) next = 0.5_wp*(low + full(3))
            if (.not. next < high) next = 0.5_wp*(full(3) + high)
            if (.not. (next > low .and. next < high)) exit
            full(3) = next
            answer%found = i < most
         end do
         answer%across = full(3)
         call condense_thickness(answer%tangent(:4, :4))
         answer%stress(3) = 0.0_wp
      else
         call respond_in_full(law, memory, m, dt, full, answer)
      end if
   end subroutine respond_small

   pure subroutine respond_in_full(law, memory, nstress, dt, strain, answer)
      type(solid_law_type), intent(in) :: law
      real(wp), contiguous, intent(in) :: memory(:)
      integer, intent(in) :: nstress
      real(wp), intent(in) :: dt, strain(6)
      type(small_answer_type), intent(inout) :: answer
      type(plastic_answer_type) :: plastic
      real(wp) :: turn(6, 6), kelvin(6)
      integer :: k

      if (.not. allocated(law%plastic)) then
         call respond_radially(law, memory, nstress, dt, strain, answer)
         return
      end if
      answer%trace = strain(1) + strain(2) + strain(3)
      call small_return(law, memory, nstress, dt, strain, turn, plastic)
      answer%found = plastic%found
      answer%distortion = norm2(plastic%stress)/(2.0_wp*law%shear)
      kelvin = matmul(turn, plastic%stress)
      answer%stress = kelvin + law%bulk*answer%trace*unit_kelvin
      answer%stress(4:) = answer%stress(4:)/root_two
      ! Recovery of the backstress makes the slope a little unsymmetric; matrices are symmetric.
      plastic%slope = 0.5_wp*(plastic%slope + transpose(plastic%slope))
      answer%tangent = matmul(turn, matmul(plastic%slope, transpose(turn)))
      do k = 1, 3
         answer%tangent(:3, k) = answer%tangent(:3, k) + law%bulk
      end do
      answer%tangent(4:, :) = answer%tangent(4:, :)/root_two
      answer%tangent(:, 4:) = answer%tangent(:, 4:)/root_two
   end subroutine respond_in_full

   !> Return to a surface, and the matrix from the axes of the material to space.
   pure subroutine small_return(law, memory, nstress, dt, strain, turn, answer)
      type(solid_law_type), intent(in) :: law
      real(wp), contiguous, intent(in) :: memory(:)
      integer, intent(in) :: nstress
      real(wp), intent(in) :: dt, strain(6)
      real(wp), intent(out) :: turn(6, 6)
      type(plastic_answer_type), intent(out) :: answer
      type(past_type) :: past
      real(wp) :: kelvin(6)

      past = past_of(memory, nstress, dt)
      turn = kelvin_rotation(transpose(law%plastic%axes))
      kelvin = strain
      kelvin(4:) = kelvin(4:)/root_two
      call return_to_surface(law%plastic, flow_at(law%flow, past%temperature), law%shear, &
         & matmul(kelvin, turn), plastic_past_of(memory, nstress, law%plastic%kinematic%n, dt), &
         & answer)
   end subroutine small_return

   !> Von Mises: the deviator of stress is along that of the strain.
   pure subroutine respond_radially(law, memory, nstress, dt, strain, answer)
      type(solid_law_type), intent(in) :: law
      real(wp), contiguous, intent(in) :: memory(:)
      integer, intent(in) :: nstress
      real(wp), intent(in) :: dt, strain(6)
      type(small_answer_type), intent(inout) :: answer
      type(return_type) :: back
      real(wp) :: deviator(6), size_of
      integer :: k

      answer%trace = strain(1) + strain(2) + strain(3)
      deviator(:3) = strain(:3) - answer%trace/3.0_wp
      deviator(4:) = 0.5_wp*strain(4:)
      size_of = magnitude(deviator(:nstress))
      back = answer_of(law, past_of(memory, nstress, dt), size_of)
      answer%distortion = back%kept*size_of
      associate (stress => answer%stress, tangent => answer%tangent)
         stress(:nstress) = back%secant*deviator(:nstress)
         stress(:3) = stress(:3) + law%bulk*answer%trace
         tangent(:nstress, :nstress) = 0.0_wp
         tangent(:3, :3) = law%bulk - back%secant/3.0_wp
         do k = 1, nstress
            tangent(k, k) = tangent(k, k) + merge(1.0_wp, 0.5_wp, k <= 3)*back%secant
         end do
         if (.not. abs(back%along) > 0.0_wp) return
         do k = 1, nstress
            tangent(:nstress, k) = tangent(:nstress, k) &
               & + back%along*(deviator(:nstress)/size_of)*(deviator(k)/size_of)
         end do
      end associate
   end subroutine respond_radially

   pure real(wp) function magnitude(deviator)
      real(wp), intent(in) :: deviator(:)
      magnitude = sqrt(sum(deviator(:3)**2) + 2.0_wp*sum(deviator(4:)**2))
   end function magnitude

   !> The memory of a point for the state that is accepted, and the plastic work since the last.
   pure subroutine keep_small(law, dt, strain, memory, work)
      type(solid_law_type), intent(in) :: law
      real(wp), intent(in) :: dt
      real(wp), intent(in) :: strain(:)   !! (4 or 6) elastic trial, engineering shears;
                                                       !! zz is that of plane stress
      real(wp), contiguous, intent(inout) :: memory(:)
      real(wp), intent(out) :: work                    !! per volume [stress]
      type(return_type) :: back
      type(plastic_answer_type) :: plastic
      real(wp) :: turn(6, 6), full(6), deviator(size(strain)), trace
      integer :: m

      m = size(strain)
      work = 0.0_wp
      if (allocated(law%plastic)) then
         full = 0.0_wp
         full(:m) = strain
         call small_return(law, memory, m, dt, full, turn, plastic)
         if (.not. plastic%step > 0.0_wp) return
         work = plastic%work
         full = matmul(turn, plastic%flow)
         full(4:) = full(4:)/root_two
         memory(:m) = memory(:m) - 2.0_wp*full(:m)
         call put_plastic(memory, m, law%plastic%kinematic%n, plastic)
         return
      end if
      trace = strain(1) + strain(2) + strain(3)
      deviator(:3) = strain(:3) - trace/3.0_wp
      deviator(4:) = 0.5_wp*strain(4:)
      back = answer_of(law, past_of(memory, m, dt), magnitude(deviator))
      if (.not. back%step > 0.0_wp) return
      memory(:m) = memory(:m) - 2.0_wp*(1.0_wp - back%kept)*deviator
      call put_return(memory, m, back%step, back%stress, work)
   end subroutine keep_small
end module lopin_material_point
