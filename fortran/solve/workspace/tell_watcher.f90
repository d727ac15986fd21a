!> The reports to a watcher of a run, gathered in one place.
module lopin_tell_watcher
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_report, only : frame_type
   use lopin_scene, only : scene_type
   use lopin_watcher, only : news_type, event_of
   implicit none
   private
   public :: tell_of_plan, tell_of_attempt, tell_of_iteration, tell_of_cut, tell_of_increment

contains

   subroutine tell_of_plan(scene, model, plan)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      character(len=*), intent(in) :: plan
      type(news_type) :: news

      if (.not. allocated(scene%watcher)) return
      call find_news(news, scene, model, event_of%plan)
      news%text = plan
      call scene%watcher%look(news)
   end subroutine tell_of_plan

   !> An increment is tried.
   subroutine tell_of_attempt(scene, model, frame)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame    !! its number, attempt and time increment are set
      type(news_type) :: news

      if (.not. allocated(scene%watcher)) return
      call find_news(news, scene, model, event_of%attempt)
      news%attempt = frame%attempt
      news%time_increment = frame%time_increment
      call scene%watcher%look(news)
   end subroutine tell_of_attempt

   !> One iteration of the nonlinear path.
   subroutine tell_of_iteration(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(news_type) :: news

      if (.not. allocated(scene%watcher)) return
      call find_news(news, scene, model, event_of%iteration)
      news%attempt = scene%newton%attempt
      news%time_increment = scene%newton%dt
      news%iterations = scene%newton%iterations
      associate (c => scene%newton%contact)
         news%closed = count(c%status(:c%n) > 0)
      end associate
      call scene%watcher%look(news)
   end subroutine tell_of_iteration

   !> The attempt is given up, and tried again with a smaller increment.
   subroutine tell_of_cut(scene, model, frame, because)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      character(len=*), intent(in) :: because
      type(news_type) :: news

      if (.not. allocated(scene%watcher)) return
      call find_news(news, scene, model, event_of%cut)
      news%attempt = frame%attempt
      news%time_increment = frame%time_increment
      news%text = because
      call scene%watcher%look(news)
   end subroutine tell_of_cut

   !> An increment is accepted and recorded.
   subroutine tell_of_increment(scene, model, frame)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      type(news_type) :: news
      integer :: pair

      if (.not. allocated(scene%watcher)) return
      call find_news(news, scene, model, event_of%increment)
      news%increment = frame%increment
      news%attempt = frame%attempt
      news%time_increment = frame%time_increment
      news%total_time = frame%total_time
      news%step_time = frame%step_time
      news%iterations = frame%iterations
      news%closed = frame%closed
      news%verdict = frame%certificate%verdict
      do pair = 1, size(frame%contact)
         associate (c => frame%contact(pair))
            if (size(c%pressure) > 0) news%pressure = max(news%pressure, maxval(c%pressure))
         end associate
      end do
      call scene%watcher%look(news)
   end subroutine tell_of_increment

   !> Where the run is, by what was accepted.
   subroutine find_news(news, scene, model, event)
      type(news_type), intent(out) :: news
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: event             !! one of `event_of`

      news%event = event
      news%step = scene%step
      news%steps = size(model%step)
      news%increment = scene%accepted%clock%number + 1
      news%step_time = scene%accepted%clock%time
      news%total_time = scene%accepted%clock%start + news%step_time
      news%whole_time = sum(model%step%period)
      if (scene%step > 0) news%period = model%step(scene%step)%period
      news%text = ''
   end subroutine find_news
end module lopin_tell_watcher
