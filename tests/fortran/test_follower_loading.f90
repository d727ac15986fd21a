program test_follower_loading
   use lopin_kinds, only : wp
   use lopin_model, only : model_type, step_type, face_load_type, amplitude_type
   use lopin_follower_loading, only : follower_type, new_followers, set_followers
   use check, only : test, close_to, is_true, finish
   implicit none
   type(model_type) :: model
   type(follower_type) :: followers

   allocate (model%amplitude(2))
   model%amplitude(1)%time = [0.0_wp, 1.0_wp, 2.0_wp]
   model%amplitude(1)%value = [0.0_wp, 1.0_wp, 0.5_wp]
   model%amplitude(2) = model%amplitude(1)
   model%amplitude(2)%total_time = .true.
   call pressures_ramp_from_step_to_step()
   call amplitudes_come_and_go()
   call finish()

contains

   !> A step whose pressures are (element, pressure, amplitude), all on face 1.
   function step_of(element, pressure, amplitude, ramp) result(step)
      integer, intent(in) :: element(:), amplitude(:)
      real(wp), intent(in) :: pressure(:)
      logical, intent(in) :: ramp
      type(step_type) :: step
      integer :: i

      allocate (step%face_load(size(element)))
      do i = 1, size(element)
         step%face_load(i)%element = element(i)
         step%face_load(i)%face = 1
         step%face_load(i)%pressure = pressure(i)
         step%face_load(i)%amplitude = amplitude(i)
      end do
      step%period = 2.0_wp
      step%ramp = ramp
      step%nlgeom = .true.
   end function step_of

   !> Pressure of all entries of an element.
   real(wp) function on(element)
      integer, intent(in) :: element
      on = sum(followers%pressure, mask=followers%element == element)
   end function on

   subroutine pressures_ramp_from_step_to_step()
      call test('pressures go linearly from step to step')
      call new_followers(followers, step_of([7, 8], [3.0_wp, 5.0_wp], [0, 0], .true.), 0.0_wp, 4)
      call set_followers(followers, model, 0.5_wp)
      call close_to('a quarter', [on(7), on(8)], [0.75_wp, 1.25_wp], 1.0e-15_wp)
      call set_followers(followers, model, 2.0_wp)
      call close_to('all', [on(7), on(8)], [3.0_wp, 5.0_wp], 0.0_wp)
      call new_followers(followers, step_of([7, 9], [1.0_wp, 4.0_wp], [0, 0], .true.), 2.0_wp, 4)
      call set_followers(followers, model, 1.0_wp)
      call close_to('half way; 8 goes out', [on(7), on(8), on(9)], [2.0_wp, 2.5_wp, 2.0_wp], &
         & 1.0e-15_wp)
      call set_followers(followers, model, 2.0_wp)
      call close_to('end', [on(7), on(8), on(9)], [1.0_wp, 0.0_wp, 4.0_wp], 0.0_wp)
      call new_followers(followers, step_of([7], [6.0_wp], [0], .false.), 4.0_wp, 4)
      call set_followers(followers, model, 0.1_wp)
      call close_to('at once', [on(7), on(8), on(9)], [6.0_wp, 0.0_wp, 0.0_wp], 0.0_wp)
      call is_true('forces have room', size(followers%force) == 4)
   end subroutine pressures_ramp_from_step_to_step

   subroutine amplitudes_come_and_go()
      type(follower_type) :: none

      call test('pressures follow amplitudes, and go on from there without them')
      followers = none
      call new_followers(followers, step_of([7, 8], [3.0_wp, 5.0_wp], [1, 2], .true.), 1.0_wp, 4)
      call set_followers(followers, model, 0.5_wp)
      call close_to('step time, total time', [on(7), on(8)], [1.5_wp, 3.75_wp], 1.0e-15_wp)
      call set_followers(followers, model, 2.0_wp)
      call close_to('end', [on(7), on(8)], [1.5_wp, 2.5_wp], 1.0e-15_wp)
      call new_followers(followers, step_of([7, 8], [4.5_wp, 5.0_wp], [0, 2], .true.), 3.0_wp, 4)
      call set_followers(followers, model, 1.0_wp)
      call close_to('on from 1.5; still on its amplitude', [on(7), on(8)], [3.0_wp, 2.5_wp], &
         & 1.0e-15_wp)
      call new_followers(followers, step_of([integer ::], [real(wp) ::], [integer ::], .true.), &
         & 5.0_wp, 4)
      call set_followers(followers, model, 1.0_wp)
      call close_to('going out', [on(7), on(8)], [1.5_wp, 1.25_wp], 1.0e-15_wp)
      call set_followers(followers, model, 2.0_wp)
      call close_to('out', [on(7), on(8)], [0.0_wp, 0.0_wp], 0.0_wp)
      call test('a pressure given again with an amplitude is replaced at once')
      followers = none
      call new_followers(followers, step_of([7], [4.0_wp], [0], .true.), 0.0_wp, 4)
      call set_followers(followers, model, 2.0_wp)
      call new_followers(followers, step_of([7], [3.0_wp], [1], .true.), 2.0_wp, 4)
      call set_followers(followers, model, 0.5_wp)
      call close_to('half of the amplitude', on(7), 1.5_wp, 1.0e-15_wp)
   end subroutine amplitudes_come_and_go
end program test_follower_loading
