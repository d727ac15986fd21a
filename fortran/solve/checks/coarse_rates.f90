!> Rates of strain in increments that are too long for them.
!>
!> An increment knows the mean rate of its strain alone, and the stress at its end is that of the
!> mean rate. While tools move steadily, a body whose height falls by a share e flows faster by e at
!> the end than at the beginning: a stress that goes as rate^m is off by m e/2.
module lopin_coarse_rates
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_stream, only : stream_type
   use lopin_model, only : model_type
   use lopin_flow_curve, only : flow_stress, is_viscous
   use lopin_material_memory, only : strain_at
   use lopin_scene, only : scene_type
   use lopin_repeated_messages, only : warn_once
   implicit none
   private
   public :: coarse_rates_type, measure_coarse_rates, tell_coarse_rates

   !> Errors of the stress that are told.
   real(wp), parameter :: told = 0.05_wp

   type :: coarse_rates_type
      real(wp) :: error = 0.0_wp               !! largest of the step so far [-]
      integer :: increment = 0                 !! where it was
   contains
      procedure :: keep => keep_rates
   end type coarse_rates_type

contains

   !> To a stream or back.
   subroutine keep_rates(self, stream)
      class(coarse_rates_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%error)
      call stream%pass(self%increment)
   end subroutine keep_rates

   !> Look at an accepted increment: the mean of m e/2 over what flows, weighted by its stress times
   !> its strain.
   subroutine measure_coarse_rates(self, scene, increment)
      type(coarse_rates_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: increment
      real(wp) :: strain, stress, slope, rate_slope, error, whole, share
      integer :: e, p, row

      if (.not. scene%trial%solids%in_use .or. .not. scene%newton%dt > 0.0_wp) return
      error = 0.0_wp
      whole = 0.0_wp
      associate (new => scene%trial%solids, old => scene%accepted%solids)
         do e = 1, size(new%first) - 1
            if (new%first(e + 1) == new%first(e)) cycle
            associate (group => scene%solids%group(scene%solids%which(e)))
               if (.not. is_viscous(group%law%flow)) cycle
               row = strain_at(group%element%nstress)
               do p = new%first(e), new%first(e + 1) - 1
                  strain = new%value(row, p) - old%value(row, p)
                  if (.not. strain > 0.0_wp) cycle
                  call flow_stress(group%law%flow, new%value(row, p), strain/scene%newton%dt, &
                     & stress, slope, rate_slope)
                  if (.not. stress > 0.0_wp) cycle
                  share = min(rate_slope*strain/(scene%newton%dt*stress), 1.0_wp)
                  error = error + 0.5_wp*share*strain*stress*strain
                  whole = whole + stress*strain
               end do
            end associate
         end do
      end associate
      if (.not. error > self%error*whole) return
      self%error = error/whole
      self%increment = increment
   end subroutine measure_coarse_rates

   !> Say at the end of a step where stresses are off; the next begins anew.
   subroutine tell_coarse_rates(self, scene, model)
      type(coarse_rates_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model

      if (self%error > told) call warn_once(scene%log, 'W0556', 'increment '// &
         & to_text(self%increment)//' of step '//to_text(scene%step)//' strains metal whose '// &
         & 'stress depends on the rate by so much that stresses and forces are off by up to '// &
         & to_text(100.0_wp*self%error, 2)//' %', model%step(scene%step)%at, &
         & help='increments of '//to_text(0.2_wp*told/self%error, 1)// &
         & ' of this length leave 1 %')
      self = coarse_rates_type()
   end subroutine tell_coarse_rates
end module lopin_coarse_rates
